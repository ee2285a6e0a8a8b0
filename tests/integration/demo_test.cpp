// `prehend demo` where something is missing, wrong or ends early, and recordings as gloves.
#include <csignal>
#include <span>

#include "tests/integration/demo_rig.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;

TEST_F(Demo, WithoutRecognitionItMapsDirectly) {
  const Answer answer = demo({"--seed", "1", "--without", "recognition"});
  ASSERT_TRUE(answer.exit_code == 0 || answer.exit_code == 1) << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_TRUE(document["object"].is_null());
  EXPECT_EQ(document["mapping"]["mode"], "direct");
  EXPECT_EQ(document["mapping"]["weight"], 0);
  EXPECT_EQ(answer.exit_code, document["grasp"]["held"].get<bool>() ? 0 : 1);
}

// One of each format; all of them with --long. Nobody in them reaches for anything, so what counts
// is that every frame is played and the grasp judged.
TEST_F(Demo, PlaysRecordingsToTheirEnds) {
  const std::pair<const char*, int> recordings[] = {
      {"leap_hand_recordings/grab.csv", 300},
      {"landmark_hand_recording/human_joint_right.csv", 300},
      {"leap_hand_recordings/wave.csv", 100},
      {"leap_hand_recordings/pinch.csv", 300},
      {"leap_hand_recordings/gun.csv", 100},
      {"leap_hand_recordings/HandSplay-110fps.csv", 250},
      {"leap_hand_recordings/Waiting-110fps.csv", 300},
      {"leap_hand_recordings/rollAndPitchWithEntry.csv", 700},
      {"leap_hand_recordings/three-claps.csv", 350},
      {"leap_hand_recordings/flapping.csv", 300},
      {"leap_hand_recordings/confidence-demo.csv", 1000},
      {"leap_hand_recordings/brian.csv", 400}};
  const std::size_t count = std::getenv("PREHEND_LONG") ? std::size(recordings) : 2;
  for (const auto& [name, frames] : std::span(recordings).first(count)) {
    const std::string file = (shared_data() / name).string();
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    SCOPED_TRACE(file);
    const Answer answer = demo({"--glove", "recording:" + file});
    ASSERT_TRUE(answer.exit_code == 0 || answer.exit_code == 1) << answer.log;
    const json document = json::parse(answer.output);
    EXPECT_GE(document["glove"]["frames"].get<int>(), frames);
    EXPECT_EQ(document["glove"]["device"], "recording");
    EXPECT_EQ(answer.exit_code, document["grasp"]["held"].get<bool>() ? 0 : 1);
  }
}

TEST_F(Demo, WithoutAHandItEndsWithAReason) {
  const Answer answer = demo({"--without", "glove", "--timeout", "8"});
  EXPECT_EQ(answer.exit_code, 1) << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["glove"]["frames"], 0);
  EXPECT_EQ(document["grasp"]["held"], false);
  EXPECT_NE(document["grasp"]["reason"].get<std::string>().find("no glove frame"),
            std::string::npos);
}

TEST_F(Demo, LeavesNoProcessBehind) {
  stage::Process process =
      start_program("prehend", {"demo", "--json", "--domain", std::to_string(domain_)});
  const std::string rig = "lab.rig=demo-" + std::to_string(process.pid()) + "-";
  // All five that it starts, the tracker known by its folder apart.
  ASSERT_TRUE(eventually(30, [&] { return processes_with(rig).size() == 4; }));
  process.signal(SIGINT);
  const auto exit = process.wait(seconds(15));
  ASSERT_TRUE(exit) << "it does not end";
  EXPECT_EQ(exit->code, 1);
  EXPECT_TRUE(processes_with(rig).empty());
}

// The page has buttons for teaching: somebody is there whom they speak to, and goes with the rest.
TEST_F(Demo, WithAPageThereIsATeacher) {
  stage::Process process =
      start_program("prehend", {"demo", "--watch", "--domain", std::to_string(domain_), "--set",
                                "console.port=0", "--set", "teacher.folder=" + folder_.string()});
  const std::string rig = "lab.rig=demo-" + std::to_string(process.pid()) + "-";
  ASSERT_TRUE(eventually(30, [&] {
    const auto teachers = processes_with(program("prehend-teacher"));
    const auto here = processes_with(rig);
    return std::any_of(here.begin(), here.end(), [&](pid_t one) {
      return std::find(teachers.begin(), teachers.end(), one) != teachers.end();
    });
  }));
  process.signal(SIGINT);
  ASSERT_TRUE(process.wait(seconds(15))) << "it does not end";
  EXPECT_TRUE(processes_with(rig).empty());
}

TEST_F(Demo, KilledItTakesTheServicesAlong) {
  stage::Process process =
      start_program("prehend", {"demo", "--json", "--domain", std::to_string(domain_)});
  const std::string rig = "lab.rig=demo-" + std::to_string(process.pid()) + "-";
  ASSERT_TRUE(eventually(30, [&] { return processes_with(rig).size() == 4; }));
  ::kill(process.pid(), SIGKILL);
  ASSERT_TRUE(process.wait(seconds(5)));
  EXPECT_TRUE(eventually(30, [&] { return processes_with(rig).empty(); }));
}

TEST_F(Demo, ADeadServiceIsNamedWithItsLastWords) {
  const Answer answer = demo({"--set", "mapping.model=" + (folder_ / "missing").string()});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_EQ(answer.output, "");
  EXPECT_NE(answer.log.find("mapping"), std::string::npos) << answer.log;
  EXPECT_NE(answer.log.find((folder_ / "missing").string()), std::string::npos) << answer.log;
}

TEST_F(Demo, WrongUseIsOneLine) {
  for (const Strings& arguments :
       {Strings{"--object", "Spoon"}, Strings{"--hand", "claw"}, Strings{"--without", "coffee"},
        Strings{"--bogus"}, Strings{"--set", "glove.colour=red"}, Strings{"--seeds", "3..1"}}) {
    const Answer answer = demo(arguments);
    EXPECT_EQ(answer.exit_code, 2) << arguments.front() << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
    EXPECT_EQ(answer.output, "");
  }
}

TEST_F(Demo, StatusTellsWhoIsThere) {
  auto simulation = start("simulation", {"lab.scene=" + scene(1)});
  Strings arguments = lab_arguments();
  arguments.insert(arguments.begin(), {"status", "--json"});
  Strings wait = arguments;
  wait.insert(wait.end(), {"--wait", "simulation", "--timeout", "20"});
  const Answer there = run("prehend", wait, 30);
  ASSERT_EQ(there.exit_code, 0) << there.output << there.log;
  const json document = json::parse(there.output);
  ASSERT_EQ(document["services"].size(), 1u);
  EXPECT_EQ(document["services"][0]["name"], "simulation");
  EXPECT_EQ(document["services"][0]["state"], "running");
  wait = arguments;
  wait.insert(wait.end(), {"--wait", "mapping", "--timeout", "1"});
  EXPECT_EQ(run("prehend", wait, 30).exit_code, 1);
}

}  // namespace
}  // namespace prehend::integration
