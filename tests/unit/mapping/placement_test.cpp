// Where the hand's base goes. toward() and yielding() are geometry of their own; Placement is
// tested for every hand. Tolerances: 1e-9 m where a few poses are multiplied, 1e-6 rad for angles,
// which are arc cosines and lose half of the digits near 0.
#include "services/mapping/core/placement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/base/random.hpp"
#include "tests/support/hands.hpp"

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

constexpr double max_distance = 0.03, max_angle = 0.35;

Pose any_pose(Random& random, double far, double turned) {
  return make_pose(
      random.normal3(far),
      Eigen::AngleAxisd(random.uniform(-turned, turned), random.normal3(1).normalized()).matrix());
}

TEST(Toward, GoesNoFartherThanItMayAndNeverAway) {
  Random random(1);
  for (int run = 0; run < 2000; ++run) {
    const Pose X_WR = any_pose(random, 0.5, 3);
    const Pose X_WG = X_WR * any_pose(random, random.uniform(0, 0.1), random.uniform(0, 1));
    const Pose moved = toward(X_WG, X_WR, max_distance, max_angle);
    EXPECT_LE((moved.translation() - X_WG.translation()).norm(), max_distance + 1e-9);
    EXPECT_LE(angle_between(moved.linear(), X_WG.linear()), max_angle + 1e-6);
    EXPECT_LE((moved.translation() - X_WR.translation()).norm(),
              (X_WG.translation() - X_WR.translation()).norm() + 1e-9);
    EXPECT_LE(angle_between(moved.linear(), X_WR.linear()),
              angle_between(X_WG.linear(), X_WR.linear()) + 1e-6);
  }
}

TEST(Toward, ArrivesWhereItCan) {
  Random random(2);
  for (int run = 0; run < 500; ++run) {
    const Pose X_WR = any_pose(random, 0.5, 3);
    Pose off = any_pose(random, 1, 0.9 * max_angle);
    off.translation() *= random.uniform(0, 0.9 * max_distance) / off.translation().norm();
    const Pose moved = toward(X_WR * off, X_WR, max_distance, max_angle);
    EXPECT_TRUE(moved.translation().isApprox(X_WR.translation(), 1e-9));
    EXPECT_LT(angle_between(moved.linear(), X_WR.linear()), 1e-6);
  }
}

// Far before the object, only what is across the approach is corrected: the way there is the
// operator's.
TEST(Toward, LeavesTheApproachToTheOperator) {
  Random random(3);
  for (int run = 0; run < 500; ++run) {
    const Pose X_WR = any_pose(random, 0.5, 3);
    Eigen::Vector3d off = random.normal3(1);
    off.head<2>() *= random.uniform(0, 0.9 * max_distance) / off.head<2>().norm();
    off.z() = -random.uniform(2 * max_distance, 0.2);
    const Pose X_WG = X_WR * Eigen::Translation3d(off);
    const Eigen::Vector3d left =
        X_WR.inverse() * toward(X_WG, X_WR, max_distance, max_angle).translation();
    EXPECT_LT(left.head<2>().norm(), 1e-9);
    EXPECT_NEAR(left.z(), off.z(), 1e-9);
  }
}

// Two fingers on either side of an object: moving the hand by y makes one distance larger by y and
// the other one smaller.
TEST(Yielding, GivesTheNearerFingerRoomAndTheOtherOneKeepsIts) {
  constexpr double room = 0.006, step = 0.002;
  Random random(4);
  int yielded = 0;
  for (int run = 0; run < 2000; ++run) {
    const double a = random.uniform(-0.01, 0.03), b = random.uniform(-0.01, 0.03);
    const auto at = [&](double y) { return Eigen::ArrayXd(Eigen::Array2d(a + y, b - y)); };
    const double y = yielding(at(-step), at(step), step, room);
    // As seen in a mirror.
    EXPECT_EQ(yielding(at(step), at(-step), step, room), -y);
    if ((a < room) == (b < room)) {
      EXPECT_EQ(y, 0) << "none comes first";
      continue;
    }
    const Eigen::ArrayXd after = at(y);
    const double nearer = a < b ? after[0] : after[1], other = a < b ? after[1] : after[0];
    EXPECT_NEAR(std::min(room - nearer, other - room), 0, 1e-12) << "all that one of them needs";
    EXPECT_GE(other, room - 1e-12);
    EXPECT_LE(nearer, room + 1e-12);
    yielded += y != 0;
  }
  EXPECT_GT(yielded, 100);
}

TEST(Yielding, FingersThatAreNotBesideTheObjectDoNotCount) {
  constexpr double step = 0.002, near = 0.001;
  // Sliding along the object, their distance hardly changes.
  const Eigen::Array2d before(near, near - 0.4 * step), after(near, near + 0.4 * step);
  EXPECT_EQ(yielding(before, after, step, 0.006), 0);
}

class PlacementOf : public testing::TestWithParam<std::string> {
 protected:
  /// The correction in force: from the human grasp frame to that of the robot hand.
  Pose correction(const Placement& placement, const Pose& X_WG) const {
    return X_WG.inverse() * placement.X_WB(X_WG) * hand_.X_BG();
  }

  const model::HandModel& hand_ = test::hand(GetParam());
  PlacementOptions options_;
  Random random_{5};
};

TEST_P(PlacementOf, GoesToTheHandAndThenToTheGraspAtItsSpeed) {
  for (int run = 0; run < 20; ++run) {
    Placement placement(hand_, options_);
    Pose X_WG = any_pose(random_, 0.5, 3);
    EXPECT_TRUE(placement.X_WB(X_WG).isApprox(X_WG * hand_.X_BG().inverse(), 1e-9));
    GraspTarget target;
    target.X_GR = make_pose(random_.normal3(0.003));
    Pose off = any_pose(random_, 1, 0.9 * options_.max_angle);
    off.translation() *= 0.015 / off.translation().norm();
    target.X_WG = X_WG * off;
    Pose last = correction(placement, X_WG);
    const auto follow = [&](double weight) {
      placement.follow(weight, milliseconds(20));
      const Pose next = correction(placement, X_WG);
      ASSERT_LE((next.translation() - last.translation()).norm(), 0.02 * options_.speed + 1e-9);
      ASSERT_LE(angle_between(next.linear(), last.linear()), 0.02 * options_.turn_speed + 1e-6);
      ASSERT_LE(next.translation().norm(), options_.max_distance + 1e-9);
      ASSERT_LE(angle_between(next.linear(), Eigen::Matrix3d::Identity()),
                options_.max_angle + 1e-6);
      last = next;
    };
    for (int i = 0; i < 50; ++i) {
      placement.aim(X_WG, target);
      follow(1);
    }
    const Pose grasp = target.X_WG * target.X_GR;
    const Pose robot = placement.X_WB(X_WG) * hand_.X_BG();
    EXPECT_LT((robot.translation() - grasp.translation()).norm(), 1e-9);
    EXPECT_LT(angle_between(robot.linear(), grasp.linear()), 1e-6);
    // Half of it for half the weight.
    for (int i = 0; i < 50; ++i) follow(0.5);
    EXPECT_NEAR(last.translation().norm(), 0.5 * (off * target.X_GR.translation()).norm(), 1e-9);
    // What was corrected stays with the hand until the object is released.
    const Pose kept = correction(placement, X_WG);
    X_WG = any_pose(random_, 0.5, 3);
    EXPECT_TRUE(correction(placement, X_WG).isApprox(kept, 1e-9));
    placement.release();
    for (int i = 0; i < 50; ++i) follow(1);
    EXPECT_TRUE(placement.X_WB(X_WG).isApprox(X_WG * hand_.X_BG().inverse(), 1e-9));
  }
}

// A hand that starts in a grip keeps its place as far as it may be corrected.
TEST_P(PlacementOf, StartsWhereTheRobotIs) {
  for (int run = 0; run < 100; ++run) {
    const Pose X_WG = any_pose(random_, 0.5, 3);
    const Pose off = any_pose(random_, 0.02, 0.5);
    Placement placement(hand_, options_);
    placement.start(X_WG, X_WG * off * hand_.X_BG().inverse());
    const Pose made = correction(placement, X_WG);
    EXPECT_NEAR(made.translation().norm(),
                std::min(off.translation().norm(), options_.max_distance), 1e-9);
    EXPECT_NEAR(
        angle_between(made.linear(), Eigen::Matrix3d::Identity()),
        std::min(angle_between(off.linear(), Eigen::Matrix3d::Identity()), options_.max_angle),
        1e-6);
  }
}

// A hand that has closed some of its fingers beside an object: yielding again and again comes to
// rest, within what may be corrected, and no finger is pushed deeper while another one is on its
// way.
TEST_P(PlacementOf, YieldsUntilItNeedNot) {
  const FingerDistances fingers(hand_);
  Detection object;
  object.shape = {model::ShapeKind::cylinder, {0.015, 0.015, 0.3}};
  GraspTarget target;
  for (int run = 0; run < 30; ++run) {
    // The cylinder lies along x of the grasp, so the fingers close across it.
    object.X_WO = Eigen::Translation3d(0, random_.uniform(-0.03, 0.03), 0) *
                  Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
    Eigen::VectorXd dof = hand_.clamp(hand_.postures().at("open"));
    for (Eigen::Index i = 0; i < dof.size(); ++i) {
      const model::HandDof& d = hand_.dofs()[static_cast<std::size_t>(i)];
      dof[i] += d.closing * random_.uniform(0, 0.8) * radian_of(d);
    }
    dof = hand_.clamp(dof);
    Placement placement(hand_, options_);
    double last = 0, moved = 0;
    for (int i = 0; i < 60; ++i) {
      placement.yield(target, object, fingers, dof);
      placement.aim(Pose::Identity(), target);
      placement.follow(1, milliseconds(100));
      const Eigen::Vector3d p = correction(placement, Pose::Identity()).translation();
      ASSERT_LT(p.head<1>().norm() + std::abs(p.z()), 1e-9) << "along y alone";
      ASSERT_LE(std::abs(p.y()), options_.max_distance + 1e-9);
      moved = std::abs(p.y() - last);
      last = p.y();
    }
    EXPECT_LT(moved, options_.yield) << "at rest, but for fingers that slide on the object";
  }
}

INSTANTIATE_TEST_SUITE_P(Hands, PlacementOf, testing::ValuesIn(test::hand_names()));

}  // namespace
}  // namespace prehend::mapping
