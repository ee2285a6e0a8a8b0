// Inverse kinematics by search, over arms of all kinds: what it finds is right, and it finds all.
// 1e-6 m and rad is asked for; the search itself ends at 1e-9.
#include "common/arm/inverse.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "tests/support/arms/arms.hpp"

using namespace prehend;
using arm::Joints;

namespace {

bool is_long() {
  return std::getenv("PREHEND_LONG") != nullptr;
}

bool holds(const std::vector<Joints>& branches, const Joints& q, double tolerance = 1e-4) {
  for (const Joints& branch : branches)
    if (test::turn_distance(branch, q) < tolerance) return true;
  return false;
}

class InverseOf : public testing::TestWithParam<std::string> {
 protected:
  const model::ArmModel& model = test::arm(GetParam());
};

// Of an arm with seven joints the redundant one is given, so that the posture can be found again.
TEST_P(InverseOf, MeetsForwardAndFindsThePostureAgain) {
  const int poses = is_long() ? 100'000 : 150;
  const arm::Inverse inverse(model);
  Random random(1);
  int lost = 0;
  double worst = 0;
  for (int k = 0; k < poses; ++k) {
    const Joints q = test::random_posture(model, random);
    const Pose X_AE = arm::end_pose(model, q);
    const auto branches =
        model.redundant < 0 ? inverse.branches(X_AE) : inverse.branches(X_AE, q[model.redundant]);
    lost += holds(branches, q) ? 0 : 1;
    for (const Joints& branch : branches)
      worst = std::max(worst, arm::way_between(arm::end_pose(model, branch), X_AE).norm());
  }
  RecordProperty("lost", lost);
  std::cout << GetParam() << ": " << poses << " poses, worst " << worst << ", posture lost " << lost
            << " times\n";
  EXPECT_LT(worst, 1e-6);
  // Near a singularity two branches lie closer than the search tells apart.
  EXPECT_LE(lost, poses / 100);
}

TEST_P(InverseOf, FindsTheSameEachTime) {
  Random random(2);
  const Pose X_AE = arm::end_pose(model, test::random_posture(model, random));
  const auto first = arm::Inverse(model).branches(X_AE),
             second = arm::Inverse(model).branches(X_AE);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_EQ(first[k], second[k]);
}

TEST_P(InverseOf, JacobianIsTheSlopeOfForward) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Joints q = test::random_posture(model, random);
    const arm::Jacobian J = arm::jacobian(model, arm::forward(model, q));
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      Joints before = q, after = q;
      before[i] -= 1e-6;
      after[i] += 1e-6;
      const arm::Vector6 slope =
          arm::way_between(arm::end_pose(model, before), arm::end_pose(model, after)) / 2e-6;
      EXPECT_LT((slope - J.col(i)).norm(), 1e-6);
    }
  }
}

TEST_P(InverseOf, WholeTurnsStayWithinLimitsAndAtThePose) {
  Random random(4);
  for (int k = 0; k < 50; ++k) {
    const Joints q = test::random_posture(model, random);
    const auto turns = arm::turns_within_limits(model, q);
    ASSERT_FALSE(turns.empty());
    EXPECT_LT((turns.front() - q).norm(), 1e-9);
    for (const Joints& turned : turns) {
      EXPECT_TRUE(arm::is_within_limits(model, turned));
      EXPECT_LT(test::turn_distance(turned, q), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, InverseOf, testing::ValuesIn(test::arm_names()));

// The closed form says how many branches there are; the search must find as many.
TEST(Search, FindsAllEightBranchesOfThePuma) {
  const model::ArmModel& puma = test::arm("puma560");
  const int poses = is_long() ? 2'000 : 60;
  Random random(5);
  int missed = 0;
  for (int k = 0; k < poses; ++k) {
    const Joints q = test::random_posture(puma, random);
    const Pose X_AE = arm::end_pose(puma, q);
    const auto found = arm::search_branches(puma, X_AE);
    for (const Joints& branch : arm::solve_puma(puma, *arm::puma_form(puma), X_AE, q))
      missed += holds(found, branch) ? 0 : 1;
    EXPECT_LE(found.size(), 8u);
  }
  std::cout << "missed " << missed << " of " << 8 * poses << " branches\n";
  EXPECT_LE(missed, 8 * poses / 200);  // 0.5 %
}

// Three parallel axes and a wrist without offsets between them: eight branches, as is published of
// this build, where none is out of reach.
TEST(Search, AnOffsetWristHasEightBranches) {
  const model::ArmModel& model = test::arm("offset_wrist");
  Joints q(6);
  q << 0.3, -1.2, 1.4, -1.1, 1.0, 0.4;
  EXPECT_EQ(arm::search_branches(model, arm::end_pose(model, q)).size(), 8u);
}

TEST(Search, ARoundSevenJointArmHasEightBranchesAtAnElbow) {
  const model::ArmModel& model = test::arm("seven_round");
  Joints q(7);
  q << 0.3, 0.7, 0.4, -1.4, 0.5, 0.9, 0.2;
  const auto branches = arm::Inverse(model).branches(arm::end_pose(model, q), q[2]);
  EXPECT_GE(branches.size(), 4u);
  EXPECT_TRUE(holds(branches, q));
}

TEST(Search, OutOfReachHasNoBranch) {
  for (const std::string& name : test::arm_names()) {
    Pose X_AE = test::arm(name).X_AS;
    X_AE.translation() += Eigen::Vector3d(3, 0, 0);
    EXPECT_TRUE(arm::Inverse(test::arm(name)).branches(X_AE).empty()) << name;
  }
}

TEST(Search, LockedJointsStayWhereTheyAre) {
  const model::ArmModel& model = test::arm("seven_offset");
  Random random(6);
  for (int joint = 0; joint < 7; ++joint) {
    const Joints q = test::random_posture(model, random);
    Joints six(6);
    six << q.head(joint), q.tail(6 - joint);
    const Pose X = arm::end_pose(arm::locked(model, joint, q[joint]), six);
    EXPECT_LT((X.matrix() - arm::end_pose(model, q).matrix()).norm(), 1e-12);
  }
}

TEST(Turns, HalfATurnIsTakenOnce) {
  EXPECT_DOUBLE_EQ(arm::wrapped(std::numbers::pi), std::numbers::pi);
  EXPECT_DOUBLE_EQ(arm::wrapped(-std::numbers::pi), std::numbers::pi);
  EXPECT_NEAR(arm::wrapped(7), 7 - 2 * std::numbers::pi, 1e-15);
}

}  // namespace
