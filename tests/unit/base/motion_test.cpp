// The movement with the least jerk [Flash1985]: from rest to rest, symmetric, and what lies before
// and after it stands.
#include "common/base/motion.hpp"

#include <gtest/gtest.h>

namespace prehend {
namespace {

TEST(MinimumJerk, GoesFromRestToRestAndIsSymmetric) {
  EXPECT_EQ(minimum_jerk(0), 0);
  EXPECT_EQ(minimum_jerk(0.5), 0.5);
  EXPECT_EQ(minimum_jerk(1), 1);
  for (double t = 0; t <= 1; t += 0.05)
    EXPECT_NEAR(minimum_jerk(t) + minimum_jerk(1 - t), 1, 1e-12);
  // Its first derivative is 30 t² (1 - t)², greatest in the middle: 1.875.
  constexpr double h = 1e-5;
  for (const double t : {0.1, 0.3, 0.5, 0.9})
    EXPECT_NEAR((minimum_jerk(t + h) - minimum_jerk(t - h)) / (2 * h),
                30 * t * t * (1 - t) * (1 - t), 1e-8);
}

TEST(MinimumJerk, StandsBeforeAndAfter) {
  EXPECT_EQ(minimum_jerk(-1), 0);
  EXPECT_EQ(minimum_jerk(7), 1);
}

TEST(Moved, IsMovedInTheWorldAndKeepsItsOrientation) {
  const Pose X = make_pose(
      {1, 2, 3}, Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()) * Eigen::Matrix3d::Identity());
  const Pose made = moved(X, {0, 0, 0.5});
  EXPECT_EQ(made.translation(), Eigen::Vector3d(1, 2, 3.5));
  EXPECT_EQ(made.linear(), X.linear());
}

}  // namespace
}  // namespace prehend
