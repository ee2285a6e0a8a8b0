// Squeezing: found by lag or torque, kept past the contact, let go by the operator only.
#include "services/mapping/core/grip_controller.hpp"

#include <gtest/gtest.h>

#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

/// A hand standing still at these DoF values, without torque.
RobotState at_rest(const Eigen::Vector4d& dof, int ms) {
  RobotState state;
  state.stamp = Time(milliseconds(ms));
  state.dof = dof;
  const auto joints = static_cast<Eigen::Index>(barrett().joints().size());
  state.velocity = Eigen::VectorXd::Zero(joints);
  state.torque = Eigen::VectorXd::Zero(joints);
  return state;
}

const Eigen::Vector4d stopped(0.2, 0.8, 0.8, 0.8);

TEST(GripController, SqueezesFingersThatLagBehind) {
  GripController grip(barrett(), {});
  const Eigen::Vector4d commanded(0.2, 0.9, 0.82, 0.9);  // finger 2 is where it should be
  for (int ms = 0; ms <= 150; ms += 10) grip.observe(at_rest(stopped, ms), commanded);
  EXPECT_TRUE(grip.touching());
  const Eigen::VectorXd squeezed = grip.squeeze(commanded);
  EXPECT_DOUBLE_EQ(squeezed[0], 0.2);
  EXPECT_DOUBLE_EQ(squeezed[1], 0.95);
  EXPECT_DOUBLE_EQ(squeezed[2], 0.82);
  EXPECT_DOUBLE_EQ(squeezed[3], 0.95);
}

TEST(GripController, WaitsUntilTheStopHasLasted) {
  GripController grip(barrett(), {});
  const Eigen::Vector4d commanded(0.2, 0.9, 0.9, 0.9);
  for (int ms = 0; ms <= 90; ms += 10) grip.observe(at_rest(stopped, ms), commanded);
  EXPECT_FALSE(grip.touching());
  // A finger that moves again begins anew.
  grip.observe(at_rest(stopped.array() - 0.03, 95), commanded);
  for (int ms = 110; ms <= 200; ms += 10) grip.observe(at_rest(stopped, ms), commanded);
  EXPECT_FALSE(grip.touching());
}

TEST(GripController, SeesAFullTorqueBeforeAnyCommand) {
  GripController grip(barrett(), {});
  for (int ms = 0; ms <= 150; ms += 10) {
    RobotState state = at_rest(stopped, ms);
    for (std::size_t j = 0; j < barrett().joints().size(); ++j)
      if (barrett().joints()[j].dof == 1)
        state.torque[static_cast<Eigen::Index>(j)] = barrett().joints()[j].max_torque;
    grip.observe(state, {});
  }
  ASSERT_TRUE(grip.contacts()[1]);
  EXPECT_DOUBLE_EQ(*grip.contacts()[1], 0.8);
  EXPECT_FALSE(grip.contacts()[2]);
  EXPECT_DOUBLE_EQ(grip.squeeze(stopped)[1], 0.95);
}

TEST(GripController, LetsGoWhenTheOperatorOpens) {
  GripController grip(barrett(), {});
  for (int ms = 0; ms <= 150; ms += 10) grip.observe(at_rest(stopped, ms), stopped.array() + 0.1);
  const auto ask = [&](double q) { return grip.squeeze(Eigen::Vector4d(0, q, q, q))[1]; };
  EXPECT_DOUBLE_EQ(ask(0.75), 0.95);  // a little less than contact is still a grip
  EXPECT_DOUBLE_EQ(ask(1.2), 0.95);   // the same squeeze, however far the operator closes
  EXPECT_DOUBLE_EQ(ask(0.69), 0.69);
  EXPECT_FALSE(grip.touching());
  EXPECT_DOUBLE_EQ(ask(0.75), 0.75);
}

// A drive that is told ever more reaches its limit and has no stiffness left: the first contact
// stays.
TEST(GripController, DoesNotCreepAfterAnObjectThatGivesWay) {
  GripController grip(barrett(), {});
  for (int ms = 0; ms <= 150; ms += 10) grip.observe(at_rest(stopped, ms), stopped.array() + 0.1);
  const Eigen::Vector4d further = stopped.array() + 0.05;
  for (int ms = 160; ms <= 300; ms += 10)
    grip.observe(at_rest(further, ms), stopped.array() + 0.15);
  EXPECT_DOUBLE_EQ(grip.squeeze(stopped)[1], 0.95);
}

TEST(GripController, GoesOnClosingWhenTheObjectSlipsAway) {
  GripController grip(barrett(), {});
  for (int ms = 0; ms <= 150; ms += 10) grip.observe(at_rest(stopped, ms), stopped.array() + 0.1);
  ASSERT_TRUE(grip.touching());
  const Eigen::Vector4d arrived = stopped.array() + 0.145;
  grip.observe(at_rest(arrived, 160), stopped.array() + 0.15);
  EXPECT_FALSE(grip.touching());
  EXPECT_DOUBLE_EQ(grip.squeeze(Eigen::Vector4d(0, 1.2, 1.2, 1.2))[1], 1.2);
}

TEST(GripController, KeepsTheSpreadWhileItTouches) {
  GripController grip(barrett(), {});
  for (int ms = 0; ms <= 150; ms += 10) grip.observe(at_rest(stopped, ms), stopped.array() + 0.1);
  EXPECT_DOUBLE_EQ(grip.squeeze(Eigen::Vector4d(0.7, 0.8, 0.8, 0.8))[0], 0.3);
  grip.squeeze(Eigen::Vector4d::Zero());  // the operator opens
  grip.observe(at_rest(stopped, 160), Eigen::Vector4d::Zero());
  EXPECT_DOUBLE_EQ(grip.squeeze(Eigen::Vector4d(0.7, 0, 0, 0))[0], 0.7);
}

}  // namespace
}  // namespace prehend::mapping
