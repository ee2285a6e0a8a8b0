// `prehend arm` as a user calls it: exit codes, JSON alone on standard output, one clear line.
#include "tests/support/command_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using Json = nlohmann::json;

using prehend::test::Answer;

class ArmCommand : public prehend::test::CommandTest {
 protected:
  ArmCommand() : CommandTest(prehend::test::in_programs("prehend arm")) {}
};

constexpr const char* nominal =
    "--pose=0.5963,-0.15005,-0.01435,0.7071067811865476,0,0.7071067811865476,0";

// The published nominal pose, in the shoulder frame: eight branches, three within the limits.
TEST_F(ArmCommand, SolvesThePumaInBothFrames) {
  const Answer answer = run(std::string("solve puma560 --json ") + nominal);
  ASSERT_EQ(answer.code, 0) << answer.complaint;
  const Json solutions = Json::parse(answer.output)["solutions"];
  ASSERT_EQ(solutions.size(), 8u);
  EXPECT_EQ(std::count_if(solutions.begin(), solutions.end(),
                          [](const Json& s) { return s["within_limits"].get<bool>(); }),
            3);
  for (const Json& solution : solutions) EXPECT_EQ(solution["joints_rad"].size(), 6u);
  const Answer base =
      run("solve puma560 --frame base --json "
          "--pose=0.5963,-0.15005,0.65745,0.7071067811865476,0,0.7071067811865476,0");
  ASSERT_EQ(base.code, 0) << base.complaint;
  EXPECT_EQ(Json::parse(base.output)["solutions"].size(), 8u);
}

// A file that includes others was said to have no links.
TEST_F(ArmCommand, XacroIsNamed) {
  const Answer answer =
      run("check " + file("ur.xacro",
                          "<robot name='ur' xmlns:xacro='http://ros.org/wiki/xacro'>\n"
                          "<xacro:include filename='ur_macro.xacro'/></robot>"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.output.find("is xacro"), std::string::npos) << answer.output;
}

TEST_F(ArmCommand, WrongUseIsOneLineAndExitCodeTwo) {
  for (const char* arguments :
       {"solve", "solve puma560", "solve nobody --pose=0,0,0,1,0,0,0",
        "solve puma560 --pose=0,0,0,0,0,0,0", "solve puma560 --pose=0,0,nan,1,0,0,0",
        "solve puma560 --pose=0,0,inf,1,0,0,0", "solve puma560 --pose=0,0,0,1",
        "solve puma560 --pose=0,0,0,1,0,0,0,", "solve puma560 --pose=a,b,c,d,e,f,g",
        "solve puma560 --frame moon --pose=0,0,0,1,0,0,0", "check", "check nobody",
        "add /nowhere.urdf --name a", "add x.urdf --name a/b"}) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.code, 2) << arguments;
    EXPECT_EQ(answer.output, "") << arguments;
    EXPECT_EQ(std::count(answer.complaint.begin(), answer.complaint.end(), '\n'), 1)
        << arguments << ": " << answer.complaint;
  }
}

TEST_F(ArmCommand, OutOfReachIsNo) {
  const Answer answer = run("solve puma560 --json --pose=2,0,0,1,0,0,0");
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(Json::parse(answer.output)["solutions"].empty());
  EXPECT_NE(answer.complaint.find("out of reach"), std::string::npos) << answer.complaint;
}

TEST_F(ArmCommand, AddsAnArmThatThenHasAName) {
  const auto& files = prehend::test::foreign_arms()[0];
  const std::string urdf = file("ur.urdf", files.urdf);
  EXPECT_EQ(run("check " + urdf).code, 0);
  const Answer added = run("add " + urdf + " --name mine --json");
  ASSERT_EQ(added.code, 0) << added.complaint;
  EXPECT_EQ(Json::parse(added.output)["joints"], 6);
  EXPECT_TRUE(std::filesystem::exists(folder / "data/prehend/models/arms/mine/arm.toml"));
  const Answer checked = run("check mine --json");
  EXPECT_EQ(checked.code, 0) << checked.complaint;
  EXPECT_TRUE(Json::parse(checked.output)["usable"]);
  const Answer solved = run("solve mine --json --pose=-0.3,-0.3,0.3,0,1,0,0");
  EXPECT_EQ(solved.code, 0) << solved.complaint;
  EXPECT_FALSE(Json::parse(solved.output)["solutions"].empty());
  EXPECT_EQ(run("add " + urdf + " --name mine").code, 2);  // it is there already
  EXPECT_EQ(run("add " + urdf + " --name puma560").code, 2);
  const Answer twice =
      run("add " + urdf + " --name mine --output " + in("data/prehend/models/arms/mine"));
  EXPECT_EQ(twice.code, 2);
  EXPECT_NE(twice.complaint.find("arms/mine: there is an arm already (remove it"),
            std::string::npos)
      << twice.complaint;
  const Answer homeless = prehend::test::answer_to("env -u HOME -u XDG_DATA_HOME " +
                                                       prehend::test::in_programs("prehend arm") +
                                                       " add " + urdf + " --name mine",
                                                   folder);
  EXPECT_NE(
      homeless.complaint.find("HOME: is not set, so your data have no folder (set it, or use"),
      std::string::npos)
      << homeless.complaint;
  const Answer handless = run("reach puma560 --hand nobody");
  EXPECT_EQ(handless.code, 2);
  EXPECT_NE(handless.complaint.find("'nobody': there is no such hand"), std::string::npos)
      << handless.complaint;
}

TEST_F(ArmCommand, NoArmIsNo) {
  std::string text = prehend::test::foreign_arms()[0].urdf;
  text.replace(text.find("type=\"revolute\""), 15, "type=\"fixed\"");
  const std::string urdf = file("five.urdf", text);
  const Answer checked = run("check --json " + urdf);
  EXPECT_EQ(checked.code, 1);
  const Json document = Json::parse(checked.output);
  EXPECT_FALSE(document["usable"]);
  EXPECT_EQ(document["findings"][0]["code"], "joint-count");
  EXPECT_EQ(run("add " + urdf + " --name five").code, 1);
  EXPECT_EQ(run("check " + file("no.urdf", "ELF")).code, 1);
  // An arm of the lab whose file was spoilt.
  std::filesystem::create_directories(folder / "spoilt");
  file("spoilt/arm.urdf", text);
  file("spoilt/arm.toml", "name = ");
  const Answer spoilt = run("solve " + (folder / "spoilt").string() + " --pose=0,0,0,1,0,0,0");
  EXPECT_EQ(spoilt.code, 3);
  EXPECT_EQ(run("check " + (folder / "spoilt").string()).code, 1);
}

}  // namespace
