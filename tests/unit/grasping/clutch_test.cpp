// The clutch of a Barrett finger: a ball before the inner link stops that joint while the outer one
// is free, so that with the clutch the outer joint goes on to its coupled angle (a third of the
// motor's) and the inner one stays where it was let go. Tolerances: the drives' give of 0.02 rad.
#include <gtest/gtest.h>

#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

const model::HandModel& barrett() {
  return test::hand("barrett");
}

int joint_named(const std::string& name) {
  for (std::size_t i = 0; i < barrett().joints().size(); ++i)
    if (barrett().joints()[i].name == name) return static_cast<int>(i);
  throw std::runtime_error(name);
}

/// A fixed ball at a place where the inner link of finger 3 meets it at about 0.8 rad.
struct Blocked {
  std::unique_ptr<World> world;
  int inner = joint_named("f3_inner"), outer = joint_named("f3_outer"), dof = 3;

  explicit Blocked(bool ball = true) {
    const Pose X_WB = make_pose(Vector3d(0, 0, 1));
    world =
        std::move(*World::create(barrett(), X_WB, VectorXd::Zero(4), WorldOptions{.table = false}));
    // On the middle of the inner link in that posture, moved off by link and ball.
    VectorXd posture = VectorXd::Zero(4);
    posture[dof] = 0.8;
    const auto X_BL = barrett().link_poses(barrett().joint_angles(posture));
    const int link = barrett().joints()[static_cast<std::size_t>(inner)].child;
    const Pose X_WL = X_WB * X_BL[static_cast<std::size_t>(link)];
    const Vector3d p_WS = X_WL * Vector3d(0.04, 0.01 + 0.01, 0);
    const Body stop{"stop", {model::ShapeKind::sphere, Vector3d::Constant(0.01)}, 0, "metal", {}};
    if (ball && !world->add_body(stop, make_pose(p_WS))) throw std::runtime_error("no ball");
  }

  void drive(double value, double time) {
    VectorXd command = VectorXd::Zero(4);
    command[dof] = value;
    ASSERT_TRUE(world->command(world->commanded_base(), command));
    for (double t = 0; t < time; t += world->time_step()) world->step();
  }
  double q(int joint) const { return world->hand_motion().joint[joint]; }
};

TEST(Clutch, TheOuterJointGoesOnWhenTheInnerOneIsBlocked) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  const HandMotion motion = hand.world->hand_motion();
  EXPECT_NEAR(hand.q(hand.inner), 0.8, 0.05);
  EXPECT_NEAR(hand.q(hand.outer), 2.0 / 3, 0.01);
  EXPECT_NEAR(motion.motor[hand.dof], 2.0, 0.03);
  EXPECT_EQ(motion.dof[hand.dof], motion.joint[hand.inner]);
  // What was let go is still pressed, with the breakaway torque and no more.
  EXPECT_NEAR(motion.torque[hand.inner], 0.5, 0.01);
}

TEST(Clutch, ALetGoJointStaysWhereItIsWhenItsObstacleGoes) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  const double released = hand.q(hand.inner);
  hand.world->move_body(0, make_pose(Vector3d(0.5, 0.5, 1)));
  hand.drive(2.0, 1.0);
  EXPECT_NEAR(hand.q(hand.inner), released, 0.03);  // without the clutch it would close to 2.0
}

TEST(Clutch, DrivenBackTheMotorTakesTheJointAgain) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  const double released = hand.q(hand.inner);
  hand.drive(1.3, 1.0);  // not yet as far back: only the outer joint opens
  EXPECT_NEAR(hand.q(hand.inner), released, 0.03);
  EXPECT_NEAR(hand.q(hand.outer), 1.3 / 3, 0.01);
  hand.drive(0.0, 2.0);  // the hand opens again fully
  EXPECT_NEAR(hand.q(hand.inner), 0, 0.005);
  EXPECT_NEAR(hand.q(hand.outer), 0, 0.005);
  hand.world->move_body(0, make_pose(Vector3d(0.5, 0.5, 1)));
  hand.drive(1.5, 2.0);  // engaged: both follow
  EXPECT_NEAR(hand.q(hand.inner), 1.5, 0.005);
  EXPECT_NEAR(hand.q(hand.outer), 0.5, 0.005);
}

// While a hand opened, the inner links still pressed the object onward, by centimetres.
TEST(Clutch, WhileTheMotorGoesBackNothingPressesTheJointOn) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  hand.drive(1.9, 0.5);  // only the outer joint opens
  const double locked = hand.q(hand.inner);
  hand.world->move_body(0, make_pose(Vector3d(0.5, 0.5, 1)));
  hand.drive(1.3, 1.0);
  EXPECT_NEAR(hand.q(hand.inner), locked, 0.002);
  hand.drive(2.05, 1.0);  // the motor presses on again
  EXPECT_GT(hand.q(hand.inner), locked + 0.005);
}

TEST(Clutch, AFreeFingerNeverBreaksAway) {
  Blocked hand(false);
  hand.drive(2.0, 2.0);
  EXPECT_NEAR(hand.q(hand.inner), 2.0, 0.005);
  const HandMotion motion = hand.world->hand_motion();
  EXPECT_EQ(motion.motor, motion.dof);
}

TEST(Clutch, HoldingStillKeepsTheOuterJointWhereItHasGone) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  const VectorXd before = hand.world->hand_motion().joint;
  hand.world->hold_still();
  for (int i = 0; i < 500; ++i) hand.world->step();
  EXPECT_LT((hand.world->hand_motion().joint - before).norm(), 0.01);
}

TEST(Clutch, ACloneKeepsWhatWasLetGo) {
  Blocked hand;
  hand.drive(2.0, 2.0);
  const auto copy = hand.world->clone();
  EXPECT_EQ(copy->hand_motion().motor, hand.world->hand_motion().motor);
  copy->move_body(0, make_pose(Vector3d(0.5, 0.5, 1)));
  for (int i = 0; i < 500; ++i) copy->step();
  EXPECT_NEAR(copy->hand_motion().joint[hand.inner], hand.q(hand.inner), 0.03);
}

}  // namespace
