// One command after another, for every hand, from any posture to any other: no joint and no base
// moves faster than it may, nothing overshoots, and fingers that close on a known object keep their
// proportion. 1e-12: sums of a few radians; 1e-7 for an angle, the arc cosine of nearly 1.
#include "services/mapping/core/motion_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/base/random.hpp"
#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

class MotionLimitsOf : public testing::TestWithParam<std::string> {
 protected:
  const model::HandModel& hand_ = test::hand(GetParam());
  MotionLimitOptions options_;
  MotionLimits limits_{hand_, options_};
  Random random_{7};

  Eigen::VectorXd any_posture() {
    Eigen::VectorXd dof(static_cast<Eigen::Index>(hand_.dofs().size()));
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& d = this->dof(i);
      dof[i] = random_.uniform(d.lower, d.upper);
    }
    return dof;
  }
  const model::HandDof& dof(Eigen::Index i) const {
    return hand_.dofs()[static_cast<std::size_t>(i)];
  }
};

TEST_P(MotionLimitsOf, FingersNeitherExceedTheirSpeedNorTheirGoal) {
  for (int run = 0; run < 300; ++run) {
    const Eigen::VectorXd before = any_posture(), goal = any_posture();
    const double together = random_.uniform();
    const Duration elapsed = milliseconds(random_.index(101));
    const double t = to_seconds(elapsed);
    const Eigen::VectorXd after = limits_.fingers(before, goal, together, elapsed);
    for (Eigen::Index i = 0; i < after.size(); ++i) {
      const double way = goal[i] - before[i], gone = after[i] - before[i];
      ASSERT_LE(std::abs(gone), dof(i).max_velocity * t + 1e-12) << dof(i).name;
      ASSERT_LE(std::abs(gone), std::abs(way) + 1e-12) << dof(i).name;
      ASSERT_GE(gone * way, -1e-12) << "the wrong way: " << dof(i).name;
    }
  }
}

// The share of its way that each closing finger goes is that of the one that takes longest. A
// finger that waits for another one goes less.
TEST_P(MotionLimitsOf, FingersThatCloseTogetherKeepTheirProportion) {
  int proportional = 0, closing = 0;
  for (int run = 0; run < 300; ++run) {
    const Eigen::VectorXd before = any_posture(), goal = any_posture();
    const double t = 0.02;
    const Eigen::VectorXd after = limits_.fingers(before, goal, 1, milliseconds(20));
    double share = 1;
    for (Eigen::Index i = 0; i < after.size(); ++i) {
      const double way = goal[i] - before[i];
      if (dof(i).closing * way <= 0) continue;
      const double speed =
          std::min(dof(i).max_velocity, options_.closing_speed * radian_of(dof(i)));
      share = std::min(share, speed * t / std::abs(way));
    }
    for (Eigen::Index i = 0; i < after.size(); ++i) {
      const double way = goal[i] - before[i];
      if (dof(i).closing * way <= 0) continue;
      const double gone = std::abs(after[i] - before[i]);
      ASSERT_LE(gone, share * std::abs(way) + 1e-12) << dof(i).name;
      ++closing;
      proportional += std::abs(gone - share * std::abs(way)) < 1e-12;
    }
  }
  EXPECT_GT(closing, 0);
  EXPECT_GT(2 * proportional, closing) << "most fingers have no other in their way";
}

// Alone, an opening finger is as fast as its joint allows, object or not.
TEST_P(MotionLimitsOf, OpeningIsNeverSlowedDown) {
  const Eigen::VectorXd open = hand_.clamp(hand_.postures().at("open"));
  for (Eigen::Index i = 0; i < open.size(); ++i) {
    if (dof(i).closing == 0) continue;
    Eigen::VectorXd before = open;
    before[i] += dof(i).closing * 0.2 * radian_of(dof(i));
    before = hand_.clamp(before);
    const Eigen::VectorXd alone = limits_.fingers(before, open, 0, milliseconds(10));
    EXPECT_EQ(limits_.fingers(before, open, 1, milliseconds(10)), alone) << dof(i).name;
    EXPECT_NE(alone, before) << dof(i).name;
  }
}

TEST_P(MotionLimitsOf, GoalsAreReachedAndKept) {
  const Eigen::VectorXd open = hand_.clamp(hand_.postures().at("open"));
  EXPECT_EQ(limits_.fingers(open, open, 0.5, milliseconds(30)), open);
  Eigen::VectorXd dof = open, goal = open;
  for (Eigen::Index i = 0; i < goal.size(); ++i)
    goal[i] += this->dof(i).closing * 0.1 * radian_of(this->dof(i));
  goal = hand_.clamp(goal);
  for (int i = 0; i < 200; ++i) dof = limits_.fingers(dof, goal, 1, milliseconds(30));
  EXPECT_TRUE(dof.isApprox(goal, 1e-9)) << (dof - goal).transpose();
}

INSTANTIATE_TEST_SUITE_P(Hands, MotionLimitsOf, testing::ValuesIn(test::hand_names()));

TEST(MotionLimitsOfTheBase, KeepItsSpeedAndArrive) {
  const MotionLimitOptions options;
  const MotionLimits limits(test::hand("barrett"), options);
  Random random(8);
  for (int run = 0; run < 100; ++run) {
    const auto any_pose = [&] {
      return make_pose(
          random.normal3(0.3),
          Eigen::AngleAxisd(random.uniform(-3, 3), random.normal3(1).normalized()).matrix());
    };
    Pose X = any_pose();
    const Pose goal = any_pose();
    for (int i = 0; i < 300; ++i) {
      const Pose next = limits.base(X, goal, milliseconds(20));
      ASSERT_LE((next.translation() - X.translation()).norm(), 0.02 * options.base_speed + 1e-12);
      ASSERT_LE(angle_between(next.linear(), X.linear()), 0.02 * options.base_turn_speed + 1e-7);
      X = next;
    }
    EXPECT_TRUE(X.isApprox(goal, 1e-9));
  }
}

TEST(MotionLimitsOfTime, APauseMovesNothingFarther) {
  const MotionLimits limits(test::hand("barrett"), {.max_step = milliseconds(100)});
  EXPECT_EQ(limits.step(milliseconds(-5)), Duration::zero());
  EXPECT_EQ(limits.step(milliseconds(40)), milliseconds(40));
  EXPECT_EQ(limits.step(std::chrono::hours(1)), milliseconds(100));
}

}  // namespace
}  // namespace prehend::mapping
