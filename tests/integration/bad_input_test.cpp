// What may be wrong with what comes from outside: each is one clear line and an exit code, or is
// counted while the lab goes on; never a crash.
#include <csignal>
#include <fstream>

#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

class BadInput : public Rig {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file) << text;
    return file.string();
  }
  /// The service refuses to run and says why on one line.
  void expect_refusal(const std::string& service, const Strings& arguments, int exit_code,
                      const std::string& word) {
    const Answer answer = run("prehend-" + service, arguments, 20);
    EXPECT_EQ(answer.exit_code, exit_code) << service << ": " << answer.log;
    EXPECT_NE(answer.log.find(word), std::string::npos) << service << ": " << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1)
        << service << ": " << answer.log;
  }
  /// Waits until the service counts something dropped for a reason with this word.
  testing::AssertionResult counts(const std::string& name, const std::string& word,
                                  double limit_s) {
    std::string heard;
    const auto status = hear<v1::ServiceStatus>(statuses_, limit_s, [&](auto& s) {
      if (s.name().to_string() != name) return false;
      heard.clear();
      for (const v1::Drop& drop : s.drops())
        heard += drop.reason().to_string() + ": " + std::to_string(drop.count()) + "; ";
      return heard.find(word) != std::string::npos;
    });
    if (status) return testing::AssertionSuccess();
    return testing::AssertionFailure() << name << " counts only «" << heard << "»";
  }

  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
  dds::Reader<v1::HandPosture> postures_ = reader(dds::hand_posture);
};

const char* const services[] = {"glove", "recognition", "mapping", "simulation"};

TEST_F(BadInput, UnknownKeyInTheConfiguration) {
  const std::string file = write("lab.toml", "[glove]\ndevise = \"synthetic\"\n");
  for (const char* service : services)
    expect_refusal(service, {"--config", file}, 2, "glove.devise");
}

TEST_F(BadInput, ConfigurationThatIsNoToml) {
  const std::string file = write("lab.toml", "[glove\n");
  for (const char* service : services)
    expect_refusal(service, {"--config", file}, 2, "lab.toml: line 1");
}

TEST_F(BadInput, MissingConfiguration) {
  for (const char* service : services)
    expect_refusal(service, {"--config", (folder_ / "none.toml").string()}, 2, "none.toml");
}

TEST_F(BadInput, MissingModels) {
  const std::string missing = (folder_ / "none.model").string();
  expect_refusal("mapping", lab_arguments({"mapping.model=" + missing}), 3, missing);
  expect_refusal("recognition", lab_arguments({"recognition.model=" + missing}), 3, missing);
  expect_refusal("simulation", lab_arguments({"simulation.hand=claw"}), 3, "claw");
}

TEST_F(BadInput, DamagedModel) {
  const std::string damaged = write("damaged.model", "this was a model once");
  expect_refusal("mapping", lab_arguments({"mapping.model=" + damaged}), 3, damaged);
  expect_refusal("recognition", lab_arguments({"recognition.model=" + damaged}), 3, damaged);
}

TEST_F(BadInput, MissingScene) {
  const std::string missing = (folder_ / "none.toml").string();
  expect_refusal("simulation", lab_arguments({"lab.scene=" + missing}), 3, missing);
}

// There is none, it is no camera, it is not even a device.
TEST_F(BadInput, AbsentCamera) {
  for (const std::string& path : {std::string("/dev/none"), std::string("/dev/null"),
                                  write("camera", "no device"), std::string("7")})
    expect_refusal("recognition",
                   lab_arguments({"recognition.source=device", "recognition.path=" + path}), 3,
                   path);
}

TEST_F(BadInput, AbsentRecording) {
  const std::string missing = (folder_ / "none.csv").string();
  expect_refusal("glove", lab_arguments({"glove.device=recording", "glove.file=" + missing}), 3,
                 missing);
}

TEST_F(BadInput, SensorsAtWrongPlaces) {
  expect_refusal("glove", lab_arguments({"glove.sites=[\"forearm\", \"thumb\"]"}), 3,
                 "no sensor is on the back of the hand");
  expect_refusal("glove", lab_arguments({"glove.sites=[\"back_of_hand\", \"toe\"]"}), 3, "toe");
  expect_refusal("glove", lab_arguments({"glove.sites=[\"back_of_hand\", \"thumb\", \"thumb\"]"}),
                 3, "two sensors at 'thumb'");
}

TEST_F(BadInput, WhatAServiceCannotWorkWith) {
  expect_refusal("planner", lab_arguments({"mapping.hand=", "simulation.hand="}), 2,
                 "mapping.hand: names no hand (choose one of ");
  expect_refusal("recognition", lab_arguments({"recognition.rate=0"}), 3,
                 "recognition.rate: must lie in 0 to 200 Hz (10 is usual)");
  expect_refusal("recognition", lab_arguments({"recognition.source=folder", "lab.lockstep=true"}),
                 3, "recognition.source: in lockstep pictures come by topic only (set ");
  const std::string two = "simulation.hands=[\"a:barrett\", \"b:barrett\"]";
  for (const auto& [service, sets, words] :
       std::vector<std::tuple<std::string, Strings, std::string>>{
           {"simulation", {"simulation.state_rate=0"}, "simulation.state_rate: must be positive"},
           {"simulation", {"simulation.brake_turn=0"}, "simulation.brake_turn: must be positive"},
           {"simulation", {"simulation.hand="}, "simulation.hand: names no hand (choose one of "},
           {"simulation",
            {"simulation.hands=[\"a:barrett\", \"b\"]"},
            "simulation.hands: b: names no hand"},
           {"simulation",
            {"simulation.hands=[\"a:barrett\", \"a:barrett\"]"},
            "simulation.hands: two hands are named a (as "},
           {"simulation",
            {two, "robot.arm=puma560"},
            "robot.arm, simulation.hands: an arm carries one hand alone (leave "},
           {"console",
            {"lab.lockstep=true"},
            "lab.lockstep: the console shows a lab that is live (or "},
           {"ros-lead",
            {"lab.lockstep=true"},
            "lab.lockstep: nodes of ROS 2 cannot lead in lockstep (set lab.lockstep to "},
           {"ros-lead", {"mapping.hand="}, "mapping.hand: names no hand (choose one of "}})
    expect_refusal(service, lab_arguments(sets), 2, words);
}

TEST_F(BadInput, GarbageOnThePort) {
  const std::string port = (folder_ / "tracker").string();
  auto tracker = start_program(
      "prehend-glove-tool", {"emulate", "--from", "synthetic", "--scene", scene(1), "--link", port,
                             "--garbage", "0.2", "--drop-bytes", "0.1"});
  ASSERT_TRUE(eventually(20, [&] { return std::filesystem::exists(port); }));
  auto glove = start("glove", {"glove.device=nest_of_birds", "glove.port=" + port});
  EXPECT_TRUE(counts("glove", "garbage", 20));
  const std::int64_t now = now_ns();
  EXPECT_TRUE(hear<v1::HandPosture>(postures_, 10, [&](auto& p) { return p.stamp_ns() > now; }));
  EXPECT_FALSE(glove.exit());
}

TEST_F(BadInput, PortThatGoesAndComesBack) {
  const std::string port = (folder_ / "tracker").string();
  const Strings emulate{"emulate", "--from", "synthetic", "--scene", scene(1), "--link", port};
  auto glove = start("glove", {"glove.device=nest_of_birds", "glove.port=" + port});
  // Not there yet: that is said, and the glove waits.
  const auto degraded = hear<v1::ServiceStatus>(
      statuses_, 20, [](auto& s) { return s.state() == v1::STATE_DEGRADED; });
  ASSERT_TRUE(degraded);
  EXPECT_NE(degraded->message().to_string().find(port), std::string::npos)
      << degraded->message().to_string();
  for (int life = 0; life < 2; ++life) {
    auto tracker = start_program("prehend-glove-tool", emulate);
    const std::int64_t now = now_ns();
    EXPECT_TRUE(hear<v1::HandPosture>(postures_, 20, [&](auto& p) { return p.stamp_ns() > now; }))
        << "life " << life;
    tracker.signal(SIGKILL);
    ASSERT_TRUE(tracker.wait(seconds(5)));
    std::filesystem::remove(port);
    const std::int64_t gone = now_ns();
    ASSERT_TRUE(hear<v1::ServiceStatus>(statuses_, 20, [&](auto& s) {
      return s.stamp_ns() > gone && s.state() == v1::STATE_DEGRADED;
    }));
    EXPECT_FALSE(glove.exit());
  }
}

TEST_F(BadInput, UnreadablePictureInAFolder) {
  const std::filesystem::path pictures = folder_ / "pictures";
  std::filesystem::create_directories(pictures);
  std::ofstream(pictures / "a.jpg") << "no picture";
  auto recognition =
      start("recognition", {"recognition.source=folder", "recognition.path=" + pictures.string()});
  const auto status = hear<v1::ServiceStatus>(statuses_, 20, [](auto& s) {
    return s.name().to_string() == "recognition" && !s.drops().empty();
  });
  EXPECT_TRUE(status) << "the picture was not counted";
  EXPECT_FALSE(recognition.exit());
}

}  // namespace
}  // namespace prehend::integration
