// `prehend hand` as a user calls it: exit codes, JSON alone on standard output, and the example of
// services/planner/README.md line by line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/file_text.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/planner/hand_import/made_hands.hpp"

namespace {

namespace test = prehend::test;
using Json = nlohmann::json;
using std::filesystem::path;

std::string read(const path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A new folder for one test.
path scratch(const std::string& name) {
  const path folder = path(testing::TempDir()) / (std::to_string(getpid()) + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

struct Answer {
  int code = -1;
  std::string output, complaint;
};

/// Runs shell text in the source folder, with the programs of this build.
Answer run(const std::string& text, const path& folder) {
  const std::string command = "cd " + prehend::test::in_sources("") +
                              " && PATH=" + prehend::test::in_programs("") + ":$PATH && (" + text +
                              "\n) >" + (folder / "out").string() + " 2>" +
                              (folder / "err").string();
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder / "out"), read(folder / "err")};
}

TEST(HandCommand, ExitCodesOfCheck) {
  const path folder = scratch("check");
  const std::string file = (folder / "hand.urdf").string();
  std::ofstream(folder / "palm.obj") << made_hands::palm_mesh();
  std::ofstream(file) << made_hands::gripper();
  EXPECT_EQ(run("prehend hand check " + file, folder).code, 0);
  std::ofstream(file) << "\x7f"
                         "ELF no hand";
  const Answer broken = run("prehend hand check --json " + file, folder);
  EXPECT_EQ(broken.code, 1) << broken.complaint;
  const Json document = Json::parse(broken.output);
  EXPECT_FALSE(document["usable"]);
  EXPECT_EQ(document["findings"][0]["code"], "not-urdf");
  EXPECT_EQ(run("prehend hand check /nowhere.urdf", folder).code, 2);
  EXPECT_EQ(run("prehend hand check", folder).code, 2);
  EXPECT_EQ(run("prehend hand add " + file + " --name a --output " + folder.string(), folder).code,
            2);  // a hand.urdf is there already
  const path other = folder / "other";
  EXPECT_EQ(run("prehend hand add " + file + " --name a --output " + other.string(), folder).code,
            1);
  EXPECT_FALSE(std::filesystem::exists(other));
}

// The mesh is in a package whose folder has another name than the package, as after a checkout.
TEST(HandCommand, AddsAForeignGripper) {
  const path folder = scratch("add");
  std::filesystem::create_directories(folder / "urdf");
  std::ofstream(folder / "palm.obj") << made_hands::palm_mesh();
  std::ofstream(folder / "urdf" / "gripper.urdf") << made_hands::gripper();
  const Answer answer =
      run("prehend hand add " + (folder / "urdf/gripper.urdf").string() +
              " --name foreign --candidates 12 --json --output " + (folder / "made").string(),
          folder);
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  const Json document = Json::parse(answer.output);
  EXPECT_EQ(document["fingertips"].size(), 2u);
  EXPECT_EQ(document["dofs"][0]["closing"], -1);
  EXPECT_TRUE(document["opposed"]);
  ASSERT_EQ(document["trial_grasps"].size(), 3u);
  EXPECT_TRUE(document["trial_grasps"][0]["held"]) << answer.output;
  EXPECT_TRUE(std::filesystem::exists(folder / "made" / "hand.toml"));

  // The page shows each posture and each trial, and every picture that it names is there.
  const std::string page = prehend::read_file(folder / "made" / "hand.html").value();
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("src=\"", at)) != std::string::npos; ++pictures) {
    at += 5;
    const path picture = folder / "made" / page.substr(at, page.find('"', at) - at);
    EXPECT_GT(std::filesystem::file_size(picture), 1000u) << picture;
  }
  const auto hand = prehend::model::HandModel::load(folder / "made");
  ASSERT_TRUE(hand) << hand.error().message();
  EXPECT_EQ(pictures, hand->postures().size() + document["trial_grasps"].size());
}

// Whom a person's fingers lead can be said; what leads nobody is refused, and nothing is written.
TEST(HandCommand, HumanFingersAreToldByLinks) {
  const path folder = scratch("fingers");
  std::ofstream(folder / "palm.obj") << made_hands::palm_mesh();
  std::ofstream(folder / "gripper.urdf") << made_hands::gripper();
  const auto add = [&](const std::string& fingers) {
    return run("prehend hand add " + (folder / "gripper.urdf").string() +
                   " --name told --candidates 1 --json --output " + (folder / "made").string() +
                   " --fingers " + fingers,
               folder);
  };
  for (const char* wrong : {"nose=left_finger", "thumb", "thumb=nowhere", "thumb=body"}) {
    const Answer refused = add(wrong);
    EXPECT_EQ(refused.code, 2) << wrong;
    EXPECT_THAT(refused.complaint, testing::HasSubstr("--fingers")) << wrong;
    EXPECT_FALSE(std::filesystem::exists(folder / "made")) << wrong;
  }
  std::ofstream(folder / "made") << "a file where the folder would be";
  const Answer blocked = add("thumb=left_finger");
  EXPECT_EQ(blocked.code, 3);
  EXPECT_THAT(blocked.complaint,
              testing::HasSubstr("made/hand.urdf: cannot be written (is there room"));
  std::filesystem::remove(folder / "made");
  EXPECT_EQ(add("thumb=left_finger,middle=right_finger").code, 0);
  const auto hand = prehend::model::HandModel::load(folder / "made");
  ASSERT_TRUE(hand) << hand.error().message();
  for (const auto& tip : hand->fingertips())
    EXPECT_EQ(tip.human, tip.name.starts_with("left") ? prehend::model::Finger::thumb
                                                      : prehend::model::Finger::middle);
}

// The folder of a package is said, a file of MuJoCo has a part in another file, and xacro that
// nobody can expand is told as that.
TEST(HandCommand, ReadsWhatStrangersBring) {
  const path folder = scratch("strangers");
  std::filesystem::create_directories(folder / "elsewhere" / "deep");
  std::ofstream(folder / "elsewhere" / "deep" / "palm.obj") << made_hands::palm_mesh();
  std::filesystem::create_directories(folder / "urdf");
  const std::string urdf = (folder / "urdf" / "gripper.urdf").string();
  std::ofstream(urdf) << made_hands::gripper();
  EXPECT_EQ(run("prehend hand check " + urdf, folder).code, 1);
  const std::string packages = " --package other=/ --package made=" + folder.string();
  EXPECT_EQ(run("prehend hand check" + packages + "/elsewhere/deep " + urdf, folder).code, 0);
  for (const std::string wrong : {"made", "made=", "=/", "made=/nowhere"})
    EXPECT_EQ(run("prehend hand check --package " + wrong + " " + urdf, folder).code, 2) << wrong;

  const std::string mjcf = test::mjcf_gripper();
  const std::size_t at = mjcf.find("<equality>"), end = mjcf.find("</mujoco>");
  std::ofstream(folder / "gripper.xml")
      << mjcf.substr(0, at) << "<include file='rest.xml'/>" << mjcf.substr(end);
  std::ofstream(folder / "rest.xml") << "<mujoco>" << mjcf.substr(at, end - at) << "</mujoco>";
  const Answer read = run("prehend hand check --json " + (folder / "gripper.xml").string(), folder);
  EXPECT_EQ(read.code, 0) << read.output;

  std::ofstream(folder / "hand.xacro") << "<robot name='a'><xacro:if value='1'/></robot>";
  const Answer xacro =
      run("PATH=" + prehend::test::in_programs("") +
              " prehend hand check --json --xacro side:=left " + (folder / "hand.xacro").string(),
          folder);
  EXPECT_EQ(xacro.code, 1);
  const Json document = Json::parse(xacro.output);
  ASSERT_EQ(document["findings"].size(), 1u);
  EXPECT_NE(document["findings"][0]["what"].get<std::string>().find("is xacro"), std::string::npos);
}

TEST(HandCommand, TheExampleOfTheReadmeRuns) {
  const std::string page = read(prehend::test::in_sources("services/planner/README.md"));
  const std::string fence = "```sh\n";
  const std::size_t begin = page.find(fence) + fence.size(), end = page.find("```", begin);
  ASSERT_NE(end, std::string::npos);
  std::string example = "set -e\n" + page.substr(begin, end - begin);
  const path folder = scratch("readme");
  const std::string written = "/tmp/my_gripper";
  for (std::size_t at; (at = example.find(written)) != std::string::npos;)
    example.replace(at, written.size(), (folder / "hand").string());
  const Answer answer = run(example, folder);
  EXPECT_EQ(answer.code, 0) << answer.output << answer.complaint;
  EXPECT_TRUE(std::filesystem::exists(folder / "hand" / "hand.toml"));
}

}  // namespace
