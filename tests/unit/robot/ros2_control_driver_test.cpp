// The driver of a controller of ROS 2 against an emulated one, in computed time: a hand of twelve.
#include "services/robot/core/ros2_control_driver.hpp"

#include <gtest/gtest.h>

#include "services/robot/core/ros2_control_emulator.hpp"
#include "tests/unit/robot/computed_wire.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot::ros2_control {
namespace {

struct Wire : ComputedWire<Emulator, Driver> {
  Wire() : ComputedWire(Emulator(hand(), {}), Driver(hand(), {})) {}
};

ros2::JointTrajectory trajectory(const std::string& said) {
  const auto parsed = ros2::parse_joint_trajectory(
      {reinterpret_cast<const std::uint8_t*>(said.data()), said.size()});
  if (!parsed) throw std::runtime_error(parsed.error().what);
  return *parsed;
}

std::string state_of(std::vector<std::string> names, std::vector<double> positions) {
  const ros2::Bytes bytes = ros2::joint_state({.names = std::move(names),
                                               .positions = std::move(positions),
                                               .velocities = {},
                                               .efforts = {}});
  return {bytes.begin(), bytes.end()};
}

TEST(Ros2ControlDriver, IsReadyOnceItHearsItsJointsAndSaysNothingBeforeItIsTold) {
  Wire wire;
  int said = 0;
  wire.hear = [&](const std::string&) { ++said; };
  EXPECT_EQ(wire.driver.phase(), Phase::offline);
  EXPECT_EQ(wire.driver.trouble(), "nobody tells its joint states");
  wire.run(0.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_EQ(wire.driver.identity(), "12 joints of ros2_control");
  EXPECT_LT((wire.driver.reading()->dof - wire.robot.measured()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(said, 0);
}

TEST(Ros2ControlDriver, FollowsWhatItIsTold) {
  Wire wire;
  wire.run(0.5);
  std::string last;
  wire.hear = [&](const std::string& said) { last = said; };
  wire.tell = posture(0.5);
  wire.run(4);
  ASSERT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_LT((wire.driver.reading()->dof - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_EQ(wire.rejects, 0u);
  EXPECT_EQ(wire.robot.refused(), 0);
  const auto told = trajectory(last);
  EXPECT_EQ(told.stamp_ns, 0);  // it begins when it comes
  ASSERT_EQ(told.points.size(), 1u);
  EXPECT_EQ(told.points[0].time_from_start, std::chrono::milliseconds(20));
}

TEST(Ros2ControlDriver, WhatIsInItsWayItPressesWithTheEffortThatItIsAllowed) {
  Wire wire;
  wire.run(0.5);
  std::string last;
  wire.hear = [&](const std::string& said) { last = said; };
  wire.robot.block(1, true);
  const auto& joint = hand().joints()[static_cast<std::size_t>(hand().dofs()[1].joint)];
  for (const double share : {1.0, 0.25}) {
    Eigen::VectorXd goal = hand().postures().at("open"), effort(12);
    const double squeeze = hand().dofs()[1].squeeze;
    goal[1] += 2 * squeeze;
    effort.setConstant(share * joint.max_torque);
    wire.driver.follow(goal, effort, wire.now());
    wire.run(0.5);
    EXPECT_NEAR(trajectory(last).points[0].positions[1] - wire.robot.measured()[1], share * squeeze,
                1e-9);
  }
}

TEST(Ros2ControlDriver, HoldsStillWhereItIs) {
  Wire wire;
  wire.run(0.5);
  wire.tell = posture(0.9);
  wire.run(0.1);
  wire.tell.reset();
  wire.driver.hold();
  const Eigen::VectorXd where = wire.robot.measured();
  ASSERT_GT((posture(0.9) - where).cwiseAbs().maxCoeff(), 0.3);
  wire.run(1);
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 0.15);
}

TEST(Ros2ControlDriver, AControllerThatFallsSilentIsFaultedAndComesBack) {
  Wire wire;
  wire.run(0.5);
  wire.tell = posture(0.9);
  wire.run(0.1);
  wire.cut = true;
  wire.run(0.4);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_EQ(wire.driver.trouble(), "its joint states have fallen silent");
  // The controller holds at the last point that came.
  const Eigen::VectorXd where = wire.robot.measured();
  wire.run(2);
  EXPECT_EQ(wire.robot.measured(), where);
  wire.tell.reset();
  wire.cut = false;
  wire.run(0.5);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.driver.trouble();
  EXPECT_EQ(wire.robot.measured(), where);
  wire.tell = posture(0.2);
  wire.run(4);
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
}

TEST(Ros2ControlDriver, GarbageNowAndThenIsLeftOut) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = garbage(3, 0x40);
  wire.tell = posture(0.4);
  wire.run(8);
  EXPECT_EQ(wire.driver.phase(), Phase::ready) << wire.first_trouble;
  EXPECT_GT(wire.rejects, 10u);
  EXPECT_LT((wire.robot.measured() - *wire.tell).cwiseAbs().maxCoeff(), 0.005);
}

TEST(Ros2ControlDriver, NothingButGarbageIsNamed) {
  Wire wire;
  wire.run(0.5);
  wire.spoil = [](std::string answer) { return answer.empty() ? answer : answer + "more"; };
  wire.run(0.2);
  EXPECT_EQ(wire.first_trouble, "");  // what comes behind a message is nobody's
  wire.spoil = [](std::string answer) { return answer.substr(0, answer.size() / 2); };
  wire.run(1);
  EXPECT_EQ(wire.first_trouble, "its joint states are damaged");
}

TEST(Ros2ControlDriver, AStuckJointIsNamed) {
  Wire wire;
  wire.run(0.5);
  wire.robot.block(1, true);
  wire.tell = posture(0.9);
  wire.run(3);
  const auto& joint = hand().joints()[static_cast<std::size_t>(hand().dofs()[1].joint)];
  EXPECT_EQ(wire.first_trouble, joint.name + " is stuck");
}

TEST(Ros2ControlDriver, JointsOfOthersAreTheirsAndMissingOnesAreNamed) {
  Driver driver(hand(), {});
  driver.connected(from_ns(0));
  EXPECT_EQ(driver.step(state_of({"elbow"}, {1}), from_ns(1'000'000)), "");
  EXPECT_EQ(driver.phase(), Phase::offline);
  const auto& first = hand().joints()[static_cast<std::size_t>(hand().dofs()[0].joint)];
  EXPECT_EQ(driver.trouble().find("its joint states do not name " + first.name), 0u)
      << driver.trouble();
  EXPECT_TRUE(driver.take_rejects().empty());
}

TEST(Ros2ControlDriver, AJointOutsideItsRangeIsNotLed) {
  Wire wire;
  Eigen::VectorXd where = posture(0.2);
  where[3] = hand().dofs()[3].upper + 0.3;
  wire.robot.measure(where);
  wire.tell = posture(0.2);
  int said = 0;
  wire.hear = [&](const std::string&) { ++said; };
  wire.run(1);
  EXPECT_EQ(wire.driver.phase(), Phase::faulted);
  EXPECT_NE(wire.driver.trouble().find("outside its range"), std::string::npos);
  EXPECT_EQ(said, 0);
}

TEST(Ros2ControlDriver, AFarewellStopsIt) {
  Wire wire;
  wire.run(0.5);
  EXPECT_EQ(wire.driver.farewell(), "");  // it was never told anything
  wire.tell = posture(0.9);
  wire.run(0.1);
  wire.robot.receive(wire.driver.farewell(), wire.passed());
  const Eigen::VectorXd where = wire.robot.measured();
  wire.robot.pass(wire.passed() + std::chrono::seconds(4));
  EXPECT_LT((wire.robot.measured() - where).cwiseAbs().maxCoeff(), 0.15);
}

TEST(Ros2ControlEmulator, ATrajectoryThatNamesOtherJointsIsRefused) {
  Emulator robot(hand(), {});
  ros2::JointTrajectory told{.names = {"elbow"},
                             .points = {{{1.0}, std::chrono::milliseconds(20)}}};
  const ros2::Bytes bytes = ros2::joint_trajectory(told);
  robot.receive({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, Duration::zero());
  EXPECT_EQ(robot.refused(), 1);
  const Eigen::VectorXd where = robot.measured();
  robot.pass(std::chrono::seconds(1));
  EXPECT_EQ(robot.measured(), where);
}

}  // namespace
}  // namespace prehend::robot::ros2_control
