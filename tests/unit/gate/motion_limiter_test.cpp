// What is cut: one axis by itself under random ways, and a place as a whole. Speeds are exact up to
// rounding, 1e-9 relative.
#include "common/gate/motion_limiter.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "tests/unit/gate/fixtures.hpp"

namespace prehend::gate {
namespace {

using Eigen::Vector3d;

/// What v has beyond what braking makes of `before`.
double gained(const Vector3d& before, const Vector3d& v) {
  const double square = before.squaredNorm();
  const double kept = square > 0 ? std::clamp(v.dot(before) / square, 0.0, 1.0) : 0.0;
  return (v - kept * before).norm();
}

// In any time T no more speed is gained than acceleration · (T + 50 ms), and the speed stays below
// its limit; nothing is cut into the other direction or beyond the goal.
TEST(Axis, KeepsSpeedAndAcceleration) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const MotionLimit limit{random.uniform(0.1, 5), random.uniform(0.1, 50)};
    Axis axis;
    axis.rest();
    Vector3d velocity = Vector3d::Zero();
    double time = 0, gain = 0, lowest = 0;  // of gain − acceleration · time
    for (int i = 0; i < 500; ++i) {
      const double t = random.uniform(0.001, 0.05);
      const Vector3d way = random.normal3(random.uniform() < 0.1 ? 10 : 0.05);
      const Vector3d gone = axis.go(way, t, limit);
      const Vector3d v = gone / t;
      EXPECT_LE(v.norm(), limit.speed * (1 + 1e-8));
      EXPECT_LE(gone.norm(), way.norm() * (1 + 1e-8));
      lowest = std::min(lowest, gain - limit.acceleration * time);
      gain += gained(velocity, v);
      time += t;
      EXPECT_LE(gain - limit.acceleration * time - lowest, limit.acceleration * 0.05 * (1 + 1e-6));
      if (!axis.too_fast() && !axis.too_hard()) {
        EXPECT_EQ(gone, way);
      }
      velocity = v;
    }
  }
}

TEST(Axis, MayBrakeAtOnce) {
  Axis axis;
  axis.rest();
  const MotionLimit limit{1, 2};
  double x = 0;
  for (int i = 0; i < 200; ++i) x += axis.go({0.01, 0, 0}, 0.01, limit).x();
  EXPECT_EQ(axis.go({0, 0, 0}, 0.01, limit), Vector3d(0, 0, 0));
  EXPECT_FALSE(axis.too_hard());
  EXPECT_GT(x, 0.5);
}

TEST(MotionLimiter, BringsAFarPlaceNearerAtTheLimitAndArrives) {
  const model::HandModel& hand = test::hand("barrett");
  MotionLimiter limiter(limits_of(hand));
  limiter.start(open_at(hand, {0, 0, 0.5}));
  Place goal = open_at(hand, {0.6, 0, 0.5});
  goal.X_WB.linear() = Eigen::AngleAxisd(3, Vector3d::UnitY()).toRotationMatrix();
  goal.dof.setConstant(1);
  goal.dof = hand.clamp(goal.dof);
  Place before = *limiter.place();
  int steps = 0;
  while (true) {
    const Passed passed = limiter.step(goal, at(20 * steps), at(20 * steps));
    EXPECT_LE((passed.place.X_WB.translation() - before.X_WB.translation()).norm(),
              1.2 * 0.02 + 1e-9);
    EXPECT_LE(angle_between(before.X_WB.linear(), passed.place.X_WB.linear()), 3.6 * 0.02 + 1e-6);
    for (std::size_t i = 0; i < hand.dofs().size(); ++i)
      EXPECT_LE(std::abs(passed.place.dof[static_cast<Eigen::Index>(i)] -
                         before.dof[static_cast<Eigen::Index>(i)]),
                1.2 * hand.dofs()[i].max_velocity * 0.02 + 1e-9);
    before = passed.place;
    ++steps;
    if (!passed.has(Cut::base_speed) && !passed.has(Cut::joint_speed)) break;
    ASSERT_LT(steps, 100);
  }
  EXPECT_EQ(before.X_WB.matrix(), goal.X_WB.matrix());
  EXPECT_EQ(before.dof, goal.dof);
  EXPECT_GE(steps, 25);  // 0.6 m at 1.2 m/s
}

// A writer may stamp as it likes: here are 20 ms between two commands, whatever it says.
TEST(MotionLimiter, ClaimsNoMoreTimeThanHasPassed) {
  const model::HandModel& hand = test::hand("barrett");
  MotionLimiter limiter(limits_of(hand));
  limiter.start(open_at(hand, {0, 0, 0.5}));
  double x = 0;
  for (int i = 0; i < 50; ++i)
    x = limiter.step(open_at(hand, {9, 0, 0.5}), at(100 * i), at(20 * i))
            .place.X_WB.translation()
            .x();
  EXPECT_LE(x, 1.2 * (0.02 * 50 + 0.3) + 1e-9);
}

// The base must stay in its box, joints within what [gate] of hand.toml leaves them.
TEST(MotionLimiter, KeepsRangesFromTheFirstPlaceOn) {
  const model::HandModel& hand = test::hand("barrett");
  Limits limits = limits_of(hand);
  limits.box_lower = {-0.5, -0.5, 0.1};
  limits.box_upper = {0.5, 0.5, 1};
  limits.upper[1] = 1;
  MotionLimiter limiter(limits);
  Place goal = open_at(hand, {0.7, 0, 0.05});
  goal.dof[1] = 1.5;
  const Passed passed = limiter.step(goal, at(0), at(0));
  EXPECT_TRUE(passed.has(Cut::box));
  EXPECT_TRUE(passed.has(Cut::joint_range));
  EXPECT_EQ(passed.place.X_WB.translation(), Vector3d(0.5, 0, 0.1));
  EXPECT_EQ(passed.place.dof[1], 1);
}

}  // namespace
}  // namespace prehend::gate
