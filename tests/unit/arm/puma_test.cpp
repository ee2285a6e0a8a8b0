// The Puma 560: its published poses, and the closed form of its inverse kinematics against forward
// kinematics. Angles are those of standard Denavit-Hartenberg parameters, places are in the
// shoulder frame. 1e-9: an answer in closed form loses a few digits of 1e-16 at straight arms and
// wrists.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "common/arm/inverse.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;
using arm::Joints;

namespace {

constexpr double pi = std::numbers::pi;

const model::ArmModel& puma() {
  return test::arm("puma560");
}

Joints degrees(std::initializer_list<double> values) {
  Joints q(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), q.begin());
  return q * pi / 180;
}

Pose in_shoulder(const Joints& q) {
  return puma().X_AS.inverse() * arm::end_pose(puma(), q);
}

double error_of(const model::ArmModel& model, const Joints& q, const Pose& X_AE) {
  return (arm::end_pose(model, q).matrix() - X_AE.matrix()).cwiseAbs().maxCoeff();
}

TEST(Puma, StandsWhereItIsPublishedToStand) {
  Eigen::Matrix3d ahead;
  ahead << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const struct {
    const char* name;
    Joints q;
    Eigen::Vector3d p;
    Eigen::Matrix3d R;
  } rows[] = {{"zero",
               degrees({0, 0, 0, 0, 0, 0}),
               {0.45210, -0.15005, 0.43180},
               Eigen::Matrix3d::Identity()},
              {"ready",
               degrees({0, 90, -90, 0, 0, 0}),
               {0.02030, -0.15005, 0.86360},
               Eigen::Matrix3d::Identity()},
              {"straight", degrees({0, 0, -90, 0, 0, 0}), {0.86360, -0.15005, -0.02030}, ahead},
              {"nominal", degrees({0, 45, 180, 0, 45, 0}), {0.59630, -0.15005, -0.01435}, ahead}};
  for (const auto& row : rows) {
    const Pose X_SE = in_shoulder(row.q);
    EXPECT_LT((X_SE.translation() - row.p).norm(), 1e-5) << row.name;  // as published: five digits
    EXPECT_LT((X_SE.linear() - row.R).norm(), 1e-9) << row.name;
  }
  EXPECT_NEAR(puma().X_AS.translation().z(), 0.6718, 1e-12);  // of the pedestal
  EXPECT_NEAR((puma().X_EF.translation()).z(), 0.05625, 1e-12);
}

TEST(Puma, LimitsAndMassesAreThePublishedOnes) {
  const double lower[] = {-160, -45, -225, -110, -100, -266},
               upper[] = {160, 225, 45, 170, 100, 266};
  const double mass[] = {17.4, 4.8, 0.82, 0.34, 0.09};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(puma().joints[i].lower, lower[i] * pi / 180, 1e-12);
    EXPECT_NEAR(puma().joints[i].upper, upper[i] * pi / 180, 1e-12);
  }
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(puma().links[i + 2].mass, mass[i]);
  // Of link 2 in its frame 2, which lies a2 further along x.
  EXPECT_LT((puma().links[2].com_L - Eigen::Vector3d(0.4318 - 0.3638, 0.006, 0.2275)).norm(), 1e-9);
  // Of link 3 in its frame 3, which is turned by -90° about x: y there is -z here.
  EXPECT_LT((puma().links[3].com_L - Eigen::Vector3d(0, 0.070, 0.15005 + 0.0141)).norm(), 1e-9);
  EXPECT_LT((puma().links[3].inertia_L.diagonal() - Eigen::Vector3d(0.066, 0.0125, 0.086)).norm(),
            1e-9);
  EXPECT_EQ(puma().payload, 2.5);
}

TEST(Puma, NominalHasEightBranchesOfWhichThreeAreWithinLimits) {
  const Joints nominal = degrees({0, 45, 180, 0, 45, 0});
  const auto branches = arm::Inverse(puma()).branches(arm::end_pose(puma(), nominal));
  ASSERT_EQ(branches.size(), 8u);
  const double published[3][6] = {{0, 0.7854, -3.1416, 0, 0.7854, 0},
                                  {2.6486, 2.3562, 0.0940, 2.5326, 0.9743, 0.3734},
                                  {2.6486, 2.3562, 0.0940, -0.6090, -0.9743, -2.7682}};
  for (const auto& row : published) {
    int like = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(arm::is_within_limits(puma(), branches[k]));
      double most = 0;
      for (Eigen::Index i = 0; i < 6; ++i) most = std::max(most, std::abs(branches[k][i] - row[i]));
      like += most < 1e-4 ? 1 : 0;
    }
    EXPECT_EQ(like, 1) << row[0] << " " << row[3];
  }
  for (std::size_t k = 3; k < 8; ++k) EXPECT_FALSE(arm::is_within_limits(puma(), branches[k]));
}

TEST(Puma, InverseMeetsForwardAtAllPoses) {
  const int poses = std::getenv("PREHEND_LONG") ? 100'000 : 5'000;
  const arm::Inverse inverse(puma());
  ASSERT_TRUE(inverse.has_closed_form());
  Random random(560);
  double worst = 0;
  for (int k = 0; k < poses; ++k) {
    const Joints q = test::random_posture(puma(), random);
    const Pose X_AE = arm::end_pose(puma(), q);
    const auto branches = inverse.branches(X_AE);
    ASSERT_EQ(branches.size(), 8u) << q.transpose();
    double own = 10;
    for (const Joints& branch : branches) {
      worst = std::max(worst, error_of(puma(), branch, X_AE));
      own = std::min(own, test::turn_distance(branch, q));
    }
    ASSERT_LT(own, 1e-6) << "the posture itself is no branch: " << q.transpose();
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(Puma, SingularWristsKeepJointFour) {
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    Joints q = test::random_posture(puma(), random);
    q[4] = 0;
    const Pose X_AE = arm::end_pose(puma(), q);
    const auto form = arm::puma_form(puma());
    const auto found = arm::solve_puma(puma(), *form, X_AE, q);
    double own = 10;
    for (const Joints& branch : found) {
      EXPECT_LT(error_of(puma(), branch, X_AE), 1e-7) << q.transpose();
      own = std::min(own, test::turn_distance(branch, q));
    }
    EXPECT_LT(own, 1e-5) << q.transpose();
  }
}

TEST(Puma, OutOfReachHasNoBranch) {
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(0, 0.1, 0.3), Eigen::Vector3d(0, 0, 0)}) {
    Pose X_AE = puma().X_AS;
    X_AE.translation() += p;
    EXPECT_TRUE(arm::Inverse(puma()).branches(X_AE).empty()) << p.transpose();
  }
}

TEST(Puma, OtherBuildsHaveNoClosedForm) {
  for (const test::ArmFiles& files : test::foreign_arms())
    EXPECT_FALSE(arm::puma_form(test::arm(files.name))) << files.name;
}

}  // namespace
