// The arm's velocity is integrated as the world does it: x += v dt. A goal that is accelerated
// within the limits is followed with the same acceleration, which is what the shaking of the hold
// test rests on; the first step of a jump in acceleration is lost, 2 ms of 64 ms.
#include "common/grasping/arm.hpp"

#include <gtest/gtest.h>

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;

constexpr double dt = 0.002;

TEST(Arm, FollowsAnAcceleratedGoalWithItsAcceleration) {
  const double a = 0.5 * 9.81, duration = 0.064;
  Arm arm;
  Pose X = Pose::Identity();
  double last = 0;
  for (int i = 1; i * dt <= duration; ++i) {
    const double t = i * dt;
    const Pose goal = make_pose(Vector3d(0.5 * a * t * t, 0, 0));
    arm.step(X, goal, Vector3d(a * t, 0, 0), {}, dt);
    X.translation() += dt * arm.velocity();
    const double acceleration = (arm.velocity().x() - last) / dt;
    // The loop makes up for the lag of half a step at the beginning.
    EXPECT_NEAR(acceleration, a, i <= 3 ? 0.3 * a : 0.05 * a) << i;
    last = arm.velocity().x();
  }
  EXPECT_NEAR(X.translation().x(), 0.5 * a * duration * duration, 5e-4);
}

TEST(Arm, KeepsToItsLimitsAndArrives) {
  const ArmLimits limits;
  Arm arm;
  Pose X = Pose::Identity();
  const Pose goal =
      make_pose(Vector3d(0.7, 0, 0), Eigen::AngleAxisd(1.5, Vector3d::UnitZ()).toRotationMatrix());
  Vector3d last = Vector3d::Zero(), last_turn = Vector3d::Zero();
  for (int i = 0; i < 2000; ++i) {
    arm.step(X, goal, Vector3d::Zero(), limits, dt);
    EXPECT_LE(arm.velocity().norm(), limits.speed * (1 + 1e-12));
    EXPECT_LE(arm.turning().norm(), limits.turn_speed * (1 + 1e-12));
    EXPECT_LE((arm.velocity() - last).norm(), limits.acceleration * dt * (1 + 1e-9));
    EXPECT_LE((arm.turning() - last_turn).norm(), limits.turn_acceleration * dt * (1 + 1e-9));
    last = arm.velocity();
    last_turn = arm.turning();
    X.translation() += dt * last;
    if (last_turn.norm() > 0)
      X.linear() = Eigen::AngleAxisd(dt * last_turn.norm(), last_turn.normalized()) *
                   Eigen::Matrix3d(X.linear());
    EXPECT_LE(X.translation().x(), 0.7 + 0.0011);  // steps of 2 ms brake late by one: v dt / 2
  }
  EXPECT_LT((X.translation() - goal.translation()).norm(), 1e-6);
  EXPECT_LT(angle_between(X.linear(), goal.linear()), 1e-6);
}

}  // namespace
