// The robot service with an emulated BarrettHand at the end of a pseudo-terminal: real processes,
// the real protocol, and what goes wrong with both.
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

using nlohmann::json;

class Robot : public Rig {
 protected:
  std::string port() const { return (folder_ / "robot_port").string(); }
  stage::Process emulate(Strings arguments = {}) {
    arguments.insert(arguments.begin(), {"emulate", "--link", port()});
    auto process = start_program("prehend-robot-tool", arguments);
    EXPECT_TRUE(eventually(20, [&] { return std::filesystem::exists(port()); }));
    return process;
  }
  /// Each side may wait seconds for a processor, beside other tests.
  Strings settings(Strings more = {}) const {
    more.insert(more.begin(),
                {"robot.port=" + port(), "safety.deadman=false", "robot.lost_after=5"});
    return more;
  }
  void serve(const Strings& more = {}) { service_.emplace(start("robot", settings(more))); }

  v2::HandCommand command(double closure) {
    v2::HandCommand message;
    message.hand("hand");
    message.model(model_);
    message.sequence_number(++sequence_);
    message.stamp_ns(now_ns());
    message.origin_ns(now_ns());
    Eigen::VectorXd dof = test::hand(model_).postures().at("open");
    for (Eigen::Index d = 0; d < dof.size(); ++d)
      if (test::hand(model_).dofs()[static_cast<std::size_t>(d)].closing != 0) dof[d] = closure;
    message.dof(convert::to_message(dof));
    message.X_WB(convert::to_message(make_pose({0, 0, 0.5})));
    message.mode(v1::MODE_DIRECT);
    return message;
  }
  void listen() {
    for (auto& sample : states_.take())
      if (!sample.info.gone) {
        state_ = sample.data;
        ++heard_;
      }
    for (auto& sample : gates_.take())
      if (!sample.info.gone) gate_ = sample.data;
    for (auto& sample : statuses_.take())
      if (!sample.info.gone && sample.data.name().to_string() == "robot") status_ = sample.data;
  }
  bool wait(double limit_s, const std::function<bool()>& condition) {
    return eventually(limit_s, [&] {
      listen();
      return condition();
    });
  }
  /// Sends every 20 ms until the condition holds.
  bool lead(double closure, double limit_s, const std::function<bool()>& condition) {
    return eventually(limit_s, [&] {
      commands_.write(command(closure));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      listen();
      return condition();
    });
  }
  double finger(std::size_t n) const { return n < state_.dof().size() ? state_.dof()[n] : -1; }
  bool says(const std::string& words) const {
    return status_.message().to_string().find(words) != std::string::npos;
  }
  std::uint64_t dropped(const std::string& reason) const {
    for (const auto& drop : status_.drops())
      if (drop.reason().to_string() == reason) return drop.count();
    return 0;
  }
  void order(v1::OperatorAction action, const std::string& argument) {
    v1::OperatorCommand message;
    message.id("test-" + std::to_string(++orders_count_));
    message.stamp_ns(now_ns());
    message.action(action);
    message.target("gate");
    message.argument(argument);
    ASSERT_TRUE(orders_.write(message));
  }
  /// Follows commands: homed before, or by itself.
  void start_ready(const Strings& emulated = {}) {
    emulator_.emplace(emulate(emulated));
    serve();
    ASSERT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
    meet(commands_);
    ASSERT_TRUE(lead(0.5, 30, [&] { return std::abs(finger(1) - 0.5) < 0.02; })) << finger(1);
  }

  dds::Writer<v2::HandCommand> commands_ = writer(dds::robot_command);
  dds::Writer<v1::OperatorCommand> orders_ = writer(dds::operator_command);
  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::HandTouch> touches_ = reader(dds::robot_touch);
  dds::Reader<v1::GateState> gates_ = reader(dds::robot_gate);
  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
  v1::HandState state_;
  v1::GateState gate_;
  v1::ServiceStatus status_;
  std::string model_ = "barrett";
  int heard_ = 0, orders_count_ = 0;
  std::uint64_t sequence_ = 0;
  std::optional<stage::Process> emulator_, service_;
};

TEST_F(Robot, IsCheckedHomedLedStoppedAndReleased) {
  emulator_.emplace(emulate());
  const Answer check =
      run("prehend-robot-tool", with_lab({"check", "--json", "--set", settings()[0]}), 30);
  ASSERT_EQ(check.exit_code, 0) << check.log;
  EXPECT_EQ(json::parse(check.output)["state"], "configured");
  const Answer home =
      run("prehend-robot-tool", with_lab({"home", "--json", "--set", settings()[0]}), 60);
  ASSERT_EQ(home.exit_code, 0) << home.log << home.output;
  EXPECT_EQ(json::parse(home.output)["state"], "ready");
  EXPECT_EQ(json::parse(home.output)["joints_rad"].size(), 4u);

  serve();
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0; }));
  meet(commands_);
  ASSERT_TRUE(lead(1.2, 30, [&] { return std::abs(finger(3) - 1.2) < 0.02; })) << finger(3);
  EXPECT_EQ(state_.joint().size(), 8u);
  const Answer status = run("prehend-robot-tool", with_lab({"status", "--json"}), 30);
  EXPECT_EQ(json::parse(status.output)["state"], "ready") << status.output;
  const Answer second = run("prehend-robot-tool", with_lab({"check", "--set", settings()[0]}), 30);
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_NE(second.log.find("another program uses the port"), std::string::npos) << second.log;

  order(v1::ACTION_STOP, "test");
  ASSERT_TRUE(wait(10, [&] { return gate_.stopped(); }));
  const double where = finger(1);
  EXPECT_FALSE(lead(0.2, 1, [&] { return std::abs(finger(1) - where) > 0.05; }));
  const Answer stopped = run("prehend-robot-tool", with_lab({"status", "--json"}), 30);
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_EQ(json::parse(stopped.output)["state"], "stopped") << stopped.output;
  order(v1::ACTION_RELEASE, "the test goes on");
  ASSERT_TRUE(wait(10, [&] { return !gate_.stopped(); }));
  EXPECT_TRUE(lead(0.2, 20, [&] { return std::abs(finger(1) - 0.2) < 0.02; }));
  EXPECT_EQ(service_->stop(seconds(10)).code, 0);
}

TEST_F(Robot, HomesByItselfWhereThatIsWanted) {
  emulator_.emplace(emulate());
  serve({"robot.home=true"});
  EXPECT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
}

TEST_F(Robot, WhatMustNotMoveDoesNotHome) {
  emulator_.emplace(emulate());
  serve({"robot.home=true", "safety.start_stopped=true"});
  ASSERT_TRUE(wait(30, [&] { return says("configured, not homed") || says("stopped"); }));
  EXPECT_FALSE(wait(1.5, [&] { return heard_ > 0; }));
  meet(orders_);
  order(v1::ACTION_RELEASE, "it may home");
  EXPECT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
}

// The stop that the service has kept holds for who talks to the robot without it.
TEST_F(Robot, HomeDoesNotMoveOneThatIsStopped) {
  emulator_.emplace(emulate());
  serve();
  ASSERT_TRUE(wait(30, [&] { return says("configured, not homed"); }));
  meet(orders_);
  order(v1::ACTION_STOP, "somebody is in the cell");
  ASSERT_TRUE(wait(10, [&] { return gate_.stopped(); }));
  EXPECT_EQ(service_->stop(seconds(10)).code, 0);
  const Strings home = with_lab({"home", "--json", "--set", settings()[0]});
  const Answer refused = run("prehend-robot-tool", home, 30);
  EXPECT_EQ(refused.exit_code, 1) << refused.output;
  EXPECT_NE(refused.log.find("somebody is in the cell"), std::string::npos) << refused.log;
  const Answer check =
      run("prehend-robot-tool", with_lab({"check", "--json", "--set", settings()[0]}), 30);
  EXPECT_EQ(json::parse(check.output)["state"], "configured") << "it was homed";
  // Whatever else stands in the place of the stop is one, and nobody waits for it.
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "state")) {
    std::filesystem::remove(file.path());
    ASSERT_EQ(::mkfifo(file.path().c_str(), 0600), 0);
  }
  EXPECT_EQ(run("prehend-robot-tool", home, 30).exit_code, 1);
}

// Whoever is at the other end of a wire may be real, also where a program (socat) brings the line
// to a pseudo-terminal. So consent is asked for, unless somebody says that it need not.
TEST_F(Robot, WhatSpeaksAtTheEndOfAWireAsksForConsent) {
  emulator_.emplace(emulate({"--homed"}));
  service_.emplace(start("robot", {"robot.port=" + port()}));
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
  EXPECT_TRUE(wait(30, [&] { return gate_.deadman(); }));
  meet(commands_);
  const double where = finger(1);
  EXPECT_FALSE(lead(0.5, 1, [&] { return std::abs(finger(1) - where) > 0.02; }));
  EXPECT_TRUE(wait(10, [&] { return dropped("command without consent") > 0; }))
      << status_.message();
  service_->stop(seconds(10));
  service_.reset();
  gate_ = {};
  serve();
  ASSERT_TRUE(wait(30, [&] { return gate_.hand().size() > 0; }));
  EXPECT_FALSE(gate_.deadman()) << "somebody has said so";
}

/// A robot of one joint, by whatever driver: it is ready, follows, and obeys a stop until it is
/// released.
class RobotOfOneJoint : public Robot {
 protected:
  RobotOfOneJoint() { model_ = "parallel_jaw"; }
  void check(const Strings& sets) {
    Strings check{"check", "--json"};
    for (const std::string& set : sets) check.insert(check.end(), {"--set", set});
    const Answer answer = run("prehend-robot-tool", with_lab(check), 30);
    ASSERT_EQ(answer.exit_code, 0) << answer.log;
    EXPECT_EQ(json::parse(answer.output)["state"], "ready");
    EXPECT_EQ(json::parse(answer.output)["joints_rad"].size(), test::hand(model_).dofs().size());
  }
  void lead_stop_and_release(const Strings& sets, double here = 0.02, double there = 0.04,
                             double within = 5e-4) {
    const auto is_at = [&](double value) { return std::abs(finger(0) - value) < within; };
    service_.emplace(start("robot", sets));
    ASSERT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
    meet(commands_);
    ASSERT_TRUE(lead(here, 30, [&] { return is_at(here); })) << finger(0);
    order(v1::ACTION_STOP, "test");
    ASSERT_TRUE(wait(10, [&] { return gate_.stopped(); }));
    EXPECT_FALSE(lead(there, 1, [&] { return std::abs(finger(0) - here) > 4 * within; }));
    order(v1::ACTION_RELEASE, "the test goes on");
    ASSERT_TRUE(wait(10, [&] { return !gate_.stopped(); }));
    EXPECT_TRUE(lead(there, 20, [&] { return is_at(there); })) << finger(0);
  }
};

TEST_F(RobotOfOneJoint, ServosAreLedAndStopped) {
  emulator_.emplace(emulate({"--device", "dynamixel", "--hand", model_}));
  const Strings servos = settings({"robot.device=dynamixel", "mapping.hand=" + model_});
  ASSERT_NO_FATAL_FAILURE(check(servos));
  ASSERT_NO_FATAL_FAILURE(lead_stop_and_release(servos));
  emulator_->stop(seconds(10));
  ASSERT_TRUE(lead(0.01, 20, [&] { return gate_.stopped(); }));
  EXPECT_EQ(gate_.stopped_by().to_string(), "the robot itself");
}

/// Those that are sold whole, with a driver of their own.
class RobotOfItsOwnKind : public RobotOfOneJoint, public testing::WithParamInterface<const char*> {
 protected:
  RobotOfItsOwnKind() { model_ = GetParam(); }
};

TEST_P(RobotOfItsOwnKind, IsLedStoppedReleasedAndNeedsItsHomingAgainAfterARestart) {
  emulator_.emplace(emulate({"--device", model_, "--homed"}));
  const Strings sets = settings({"robot.device=" + model_});
  ASSERT_NO_FATAL_FAILURE(check(sets));
  ASSERT_NO_FATAL_FAILURE(lead_stop_and_release(sets, 0.3, 0.45, 0.02));
  emulator_->stop(seconds(10));
  ASSERT_TRUE(lead(0.3, 20, [&] { return gate_.stopped(); }));
  EXPECT_EQ(gate_.stopped_by().to_string(), "the robot itself");
  // Switched off and on, a gripper must be activated again, and says so.
  const bool homes = model_.starts_with("robotiq");
  const int before = heard_;
  emulator_.emplace(emulate({"--device", model_}));
  ASSERT_TRUE(wait(30, [&] {
    return homes ? says("it is not activated (activating it opens") : heard_ > before + 10;
  })) << status_.message();
  EXPECT_TRUE(gate_.stopped());
}

INSTANTIATE_TEST_SUITE_P(All, RobotOfItsOwnKind,
                         testing::Values("robotiq_2f85", "robotiq_2f140", "inspire_rh56"));

/// A controller of ROS 2, in a namespace and a domain of its own.
class RobotOfRos : public RobotOfOneJoint {
 protected:
  RobotOfRos() { ::setenv("ROS_DOMAIN_ID", std::to_string(nodes_.domain()).c_str(), 1); }
  ~RobotOfRos() override { ::unsetenv("ROS_DOMAIN_ID"); }
  std::string controller() const { return "/" + name_ + "/joint_trajectory_controller"; }
  Strings controlled() const {
    return {"robot.device=ros2_control", "mapping.hand=" + model_, "robot.port=" + controller(),
            "safety.deadman=false"};
  }
  stage::Process control(Strings faults = {}) {
    Strings arguments{"emulate", "--device", "ros2_control", "--hand", model_};
    arguments.insert(arguments.end(), faults.begin(), faults.end());
    arguments.insert(arguments.end(), {"--set", "robot.port=" + controller()});
    auto process = start_program("prehend-robot-tool", with_lab(arguments));
    EXPECT_TRUE(eventually(20, [&] {
      return stage::last_lines(process.log(), 5).find("/joint_trajectory,") != std::string::npos;
    }));
    return process;
  }

  const test::DomainLease nodes_;
};

TEST_F(RobotOfRos, AControllerOfRosIsCheckedLedStoppedAndReleased) {
  emulator_.emplace(control());
  ASSERT_NO_FATAL_FAILURE(check(controlled()));
  ASSERT_NO_FATAL_FAILURE(lead_stop_and_release(controlled()));
  EXPECT_EQ(service_->stop(seconds(10)).code, 0);
}

TEST_F(RobotOfRos, AControllerThatIsGoneStopsItUntilItIsReleased) {
  emulator_.emplace(control({"--garbage", "0.03", "--drop-bytes", "0.03"}));
  service_.emplace(start("robot", controlled()));
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
  meet(commands_);
  // What is no message is counted and left out.
  EXPECT_TRUE(lead(0.02, 30, [&] {
    return std::abs(finger(0) - 0.02) < 5e-4 &&
           dropped("joint state is no whole sensor_msgs/JointState") > 0;
  })) << finger(0);
  emulator_->stop(seconds(10));
  ASSERT_TRUE(lead(0.02, 20, [&] { return gate_.stopped(); }));
  EXPECT_EQ(gate_.stopped_by().to_string(), "the robot itself");
  EXPECT_NE(gate_.reason().to_string().find("joint states have fallen silent"), std::string::npos);
  emulator_.emplace(control());
  const int before = heard_;
  ASSERT_TRUE(wait(30, [&] { return heard_ > before + 10; })) << status_.message();
  const double where = finger(0);
  EXPECT_FALSE(lead(0.02, 1, [&] { return std::abs(finger(0) - where) > 2e-3; }));
  EXPECT_TRUE(gate_.stopped());
  order(v1::ACTION_RELEASE, "it is there again");
  EXPECT_TRUE(lead(0.02, 20, [&] { return std::abs(finger(0) - 0.02) < 5e-4; })) << finger(0);
}

TEST_F(Robot, ATwinGoesWithTheRobotButForAJointThatIsStuck) {
  auto simulation = start("simulation", {"simulation.hand=barrett", "simulation.hand_name=twin"});
  emulator_.emplace(emulate({"--homed", "--stuck", "finger 2", "--stuck-for", "1000"}));
  serve();
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0; })) << status_.message();
  meet(commands_, 2);
  const auto compare = [&](const std::string& name) {
    stage::Process::Options options;
    options.command = {program("prehend-robot-tool")};
    for (const std::string& word :
         with_lab({"twin", "--json", "--seconds", "3", "--within", "0.15", "--twin", name}))
      options.command.push_back(word);
    options.log = folder_ / (name + ".log");
    options.output = folder_ / (name + ".json");
    return stage::Process::start(options).value();
  };
  // One is a hand of another kind.
  auto twin = compare("twin"), stranger = compare("stranger");
  std::optional<stage::Process::Exit> exit;
  auto strangers = writer(dds::robot_state);
  v1::HandState strange;
  strange.hand("stranger");
  strange.model("robonaut");
  v1::HandTouch felt;
  const auto presses = [](const v1::PadTouch& pad) { return pad.touching(); };
  // Not so far that the robot itself notices.
  ASSERT_TRUE(lead(0.35, 60, [&] {
    strangers.write(strange);
    for (auto& sample : touches_.take())
      if (sample.data.hand().to_string() == "hand") felt = sample.data;
    return (exit = twin.exit()) && stranger.exit() &&
           std::any_of(felt.pads().begin(), felt.pads().end(), presses);
  }));
  // What holds a finger back is felt at its tip, and at no other.
  for (std::size_t l = 0; l < felt.pads().size(); ++l) {
    const int finger = test::hand(model_).links()[l].finger;
    const auto& pad = felt.pads()[l];
    EXPECT_EQ(pad.touching(), pad.valid() && finger == 1) << pad.link().to_string();
    EXPECT_EQ(pad.pressure() > 1, pad.touching()) << pad.pressure();
  }
  EXPECT_EQ(felt.pads().size(), test::hand(model_).links().size());
  const std::string refusal = stage::last_lines(stranger.log(), 1);
  EXPECT_NE(
      refusal.find("stands for robonaut, the robot is barrett (set simulation.hand = barrett)"),
      std::string::npos);
  const std::string said = read_file(folder_ / "twin.json").value_or("");
  ASSERT_EQ(exit->code, 1) << said << stage::last_lines(folder_ / "twin.log", 3);
  const json document = json::parse(said);
  EXPECT_GT(document["compared"], 50);
  for (const json& dof : document["dofs"])
    EXPECT_EQ(dof["parted_s"].is_number(), dof["name"] == "finger 2") << document;
  EXPECT_FALSE(gate_.stopped());
}

TEST_F(Robot, WithoutHomingItMovesNothing) {
  emulator_.emplace(emulate());
  serve();
  ASSERT_TRUE(wait(30, [&] { return says("configured, not homed"); }));
  meet(commands_);
  EXPECT_TRUE(lead(1, 20, [&] { return dropped("the robot is not ready") > 0; }));
  EXPECT_EQ(heard_, 0);
}

TEST_F(Robot, ACutCableStopsItUntilItIsReleased) {
  start_ready({"--homed"});
  emulator_->stop(seconds(10));
  ASSERT_TRUE(lead(0.5, 20, [&] { return gate_.stopped(); }));
  EXPECT_EQ(gate_.stopped_by().to_string(), "the robot itself");
  emulator_.emplace(emulate({"--homed"}));
  // It is back, and stays stopped.
  const int before = heard_;
  ASSERT_TRUE(wait(30, [&] { return heard_ > before + 10; })) << status_.message();
  EXPECT_FALSE(lead(1.5, 1, [&] { return finger(1) > 0.1; })) << finger(1);
  EXPECT_TRUE(gate_.stopped());
  order(v1::ACTION_RELEASE, "the cable is in again");
  EXPECT_TRUE(lead(1.5, 30, [&] { return finger(1) > 1.4; })) << finger(1);
}

TEST_F(Robot, GarbageIsCountedAndLeftOut) {
  start_ready({"--homed", "--garbage", "0.03", "--drop-bytes", "0.03", "--late", "0.01",
               "--late-by", "0.05"});
  EXPECT_TRUE(lead(1.2, 30, [&] {
    return dropped("garbled answer") + dropped("no answer") > 3 && finger(2) > 1.1;
  })) << status_.message();
}

TEST_F(Robot, ARobotThatFallsSilentIsStopped) {
  start_ready({"--homed"});
  ::kill(emulator_->pid(), SIGSTOP);
  EXPECT_TRUE(lead(0.5, 20, [&] { return gate_.stopped(); }));
  EXPECT_NE(gate_.reason().to_string().find("the wire is lost"), std::string::npos);
  ::kill(emulator_->pid(), SIGCONT);
}

TEST_F(Robot, AStuckJointIsNamed) {
  emulator_.emplace(emulate({"--homed", "--stuck", "finger 2", "--stuck-for", "1000"}));
  serve();
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0; }));
  meet(commands_);
  EXPECT_TRUE(lead(1.5, 30, [&] { return gate_.stopped(); }));
  EXPECT_NE(gate_.reason().to_string().find("finger 2 is stuck"), std::string::npos)
      << gate_.reason();
}

TEST_F(Robot, AHotRobotIsNotLed) {
  emulator_.emplace(emulate({"--homed", "--hot", "0", "--hot-for", "1000"}));
  serve();
  EXPECT_TRUE(wait(30, [&] { return says("faulted: too hot"); })) << status_.message();
  EXPECT_EQ(heard_, 0);
}

TEST_F(Robot, WrongUseIsOneLine) {
  const auto refused = [&](const Strings& sets, const std::string& words) {
    auto process = start("robot", sets);
    const auto ended = process.wait(seconds(20));
    ASSERT_TRUE(ended) << words;
    EXPECT_EQ(ended->code, 2) << words;
    EXPECT_NE(stage::last_lines(process.log(), 3).find(words), std::string::npos) << words;
  };
  refused({}, "robot.port: names no port");
  refused(settings({"robot.device=nothing"}), "there is no driver");
  refused({"robot.port=/dev/null", "robot.baud=1234"},
          "robot.baud = 1234: is no rate of this hand");
  refused({"lab.lockstep=true"}, "lab.lockstep: a robot cannot wait for the others (set it");
  const Answer nobody =
      run("prehend-robot-tool", with_lab({"check", "--set", "robot.port=/nowhere"}), 30);
  EXPECT_EQ(nobody.exit_code, 3);
  EXPECT_NE(nobody.log.find("there is no such port"), std::string::npos) << nobody.log;
}

}  // namespace
}  // namespace prehend::integration
