// An arm that carries the hand, in real processes: what it says of itself is true, a stop brakes
// it, a demonstration with it is held and recorded, and what does not fit is one line.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/arm/kinematics.hpp"
#include "common/arm/mounting.hpp"
#include "common/model/arm_choice.hpp"
#include "tests/integration/safety_rig.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using json = nlohmann::json;

constexpr double bracket = 0.6;
const Strings with_arm{"robot.arm=puma560", "robot.bracket=0.6",
                       "robot.X_WA=[0.05, -0.7, 0, 0.70710678, 0, 0, 0.70710678]"};

/// Level and away from the arm, the palm's x axis up.
v2::HandCommand wished(v2::HandCommand command, const Vector3d& p_WG) {
  const Eigen::Matrix3d R = model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  const Pose X_WG = make_pose(p_WG, R);
  command.X_WB(convert::to_message(X_WG * test::hand("barrett").X_BG().inverse()));
  return command;
}

class Arm : public SafetyRig {
 protected:
  void listen_to_arm() {
    listen();
    for (auto& sample : arm_states_.take())
      if (!sample.info.gone) heard_states_.push_back(sample.data);
    for (auto& sample : arm_commands_.take())
      if (!sample.info.gone) arm_command_ = sample.data;
  }
  double speed() const {
    double most = 0;
    if (!heard_states_.empty())
      for (const double v : heard_states_.back().velocity()) most = std::max(most, std::abs(v));
    return most;
  }
  /// Sends the wish until the condition holds.
  bool lead(double limit_s, const Vector3d& p_WG, const std::function<bool()>& condition) {
    return send(
        commands_, limit_s, [&] { return wished(command(beginning), p_WG); },
        [&] {
          listen_to_arm();
          return condition();
        });
  }
  void start_arm() {
    simulation_.emplace(start("simulation", with_arm));
    meet(commands_);
    meet(orders_);
    ASSERT_TRUE(lead(30, {0, -0.2, 0.3}, [&] {
      return !heard_states_.empty() && heard_states_.back().hindrance() == v1::HINDRANCE_NONE &&
             heard_states_.back().origin_ns() != 0;
    })) << "it does not come to where it is led";
  }

  dds::Writer<v1::OperatorCommand> orders_ = writer(dds::operator_command);
  dds::Reader<v1::ArmState> arm_states_ = reader(dds::arm_state);
  dds::Reader<v1::ArmCommand> arm_commands_ = reader(dds::arm_command);
  std::vector<v1::ArmState> heard_states_;
  v1::ArmCommand arm_command_;
};

TEST_F(Arm, SaysWhereItIsAndBrakesAtAStop) {
  start_arm();
  ASSERT_FALSE(HasFatalFailure());
  // It is where its joints say.
  const auto puma = model::load_arm("puma560");
  ASSERT_TRUE(puma) << puma.error().message();
  const model::HandModel& hand = test::hand("barrett");
  const Pose X_EB = puma->X_EF * arm::mounted(hand, bracket);
  const Pose X_WA = *checked_pose({0.05, -0.7, 0}, {0.70710678, 0, 0, 0.70710678});
  for (const v1::ArmState& state : heard_states_) {
    ASSERT_EQ(state.model().to_string(), "puma560");
    const arm::Joints q = Eigen::Map<const Eigen::VectorXd>(
        state.joint().data(), static_cast<Eigen::Index>(state.joint().size()));
    const Pose X_WB = X_WA * arm::end_pose(*puma, q) * X_EB;
    const auto told = convert::from_message(state.X_WB());
    ASSERT_TRUE(told);
    EXPECT_LT((X_WB.translation() - told->translation()).norm(), 1e-9);
    EXPECT_LT(angle_between(X_WB.linear(), told->linear()), 1e-7);
    EXPECT_TRUE(convert::from_message(state.X_WA())->isApprox(X_WA, 1e-9));
    for (std::size_t i = 0; i < puma->joints.size(); ++i) {
      EXPECT_LE(std::abs(state.velocity()[i]), puma->joints[i].velocity + 1e-3);
      EXPECT_LE(std::abs(state.torque()[i]), puma->joints[i].max_torque + 1e-9);
    }
  }
  EXPECT_EQ(arm_command_.joint().size(), 6u);
  EXPECT_EQ(arm_command_.arm().to_string(), "arm");
  // So is the hand.
  EXPECT_LT((base() - convert::from_message(heard_states_.back().X_WB().position())).norm(), 0.02);

  // A stop in the middle of a motion.
  ASSERT_TRUE(lead(20, {-0.2, 0.1, 0.4}, [&] { return speed() > 0.3; }));
  v1::OperatorCommand stop;
  stop.id("stop-1");
  stop.stamp_ns(now_ns());
  stop.action(v1::ACTION_STOP);
  stop.argument("a test");
  ASSERT_TRUE(orders_.write(stop));
  // Commands go on; they are refused.
  ASSERT_TRUE(lead(20, {-0.2, 0.1, 0.4}, [&] {
    return gate_.stopped() && speed() < 1e-6 &&
           heard_states_.back().hindrance() == v1::HINDRANCE_NO_WISH;
  })) << speed();
  const auto rests = heard_states_.back().joint();
  const std::size_t then = heard_states_.size();
  ASSERT_TRUE(lead(20, {0.2, 0.1, 0.4}, [&] { return heard_states_.size() > then + 50; }));
  EXPECT_EQ(heard_states_.back().joint(), rests) << "it moves though it is stopped";

  // Led again, and far out of reach: that is said.
  ASSERT_EQ(run("prehend", with_lab({"release", "--reason", "goes on"}), 30).exit_code, 0);
  EXPECT_TRUE(lead(30, {0, 0.6, 0.3}, [&] { return says("puma560 is "); }))
      << status_.message().to_string();
  EXPECT_TRUE(lead(30, {0, -0.2, 0.3}, [&] { return status_.state() == v1::STATE_RUNNING; }))
      << status_.message().to_string();
  EXPECT_EQ(simulation_->stop(seconds(10)).code, 0);
}

TEST_F(Arm, ADemonstrationWithItIsHeldAndRecorded) {
  const std::string file = (folder_ / "arm.mcap").string();
  const Answer answer = run("prehend",
                            {"demo", "--json", "--domain", std::to_string(domain_), "--seed", "1",
                             "--arm", "puma560", "--record", file},
                            60);
  ASSERT_EQ(answer.exit_code, 0) << answer.output << answer.log;
  const json document = json::parse(answer.output);
  EXPECT_EQ(document["grasp"]["held"], true);
  EXPECT_EQ(document["mapping"]["hand"], "barrett");
  EXPECT_EQ(document["arm"]["name"], "puma560");
  EXPECT_GT(document["arm"]["worst_joint_speed"].get<double>(), 0.05);
  EXPECT_LE(document["arm"]["worst_joint_speed"].get<double>(), 1.001);
  EXPECT_LT(document["arm"]["out_of_reach"].get<double>(), 0.5);
  const Answer info = run("prehend-recording", {"info", file}, 30);
  EXPECT_NE(info.output.find("arm/state"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("arm/command"), std::string::npos) << info.output;
}

TEST_F(Arm, WhatDoesNotFitIsOneLine) {
  const auto one_line = [](const Answer& answer, const std::string& words) {
    EXPECT_EQ(answer.exit_code, 2) << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
    EXPECT_NE(answer.log.find(words), std::string::npos) << answer.log;
  };
  const auto demo = [&](Strings arguments) {
    arguments.insert(arguments.begin(), {"demo", "--json", "--domain", std::to_string(domain_)});
    return run("prehend", arguments, 30);
  };
  one_line(demo({"--arm", "claw"}), "there is no such arm");
  one_line(demo({"--arm", "puma560", "--hand", "robonaut"}), "its payload is 2.50 kg");
  const auto simulation = [&](const Strings& sets) {
    return run("prehend-simulation", lab_arguments(sets), 30);
  };
  one_line(simulation({"robot.arm=claw"}), "there is no such arm");
  one_line(simulation({"robot.arm=puma560", "simulation.hand=robonaut"}), "cannot carry robonaut");
  one_line(simulation({"robot.arm=puma560", "robot.bracket=2"}), "robot.bracket");
  one_line(simulation({"robot.arm=puma560", "robot.X_WA=[0, 1]"}), "robot.X_WA");
  one_line(simulation({"robot.arm=puma560", "robot.X_EB=[0, 0, 0, 0, 0, 0, 0]"}), "robot.X_EB");
}

}  // namespace
}  // namespace prehend::integration
