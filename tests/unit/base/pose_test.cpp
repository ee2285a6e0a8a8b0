// Rigid transforms: what comes from outside is checked, steps are limited as stated.
#include "common/base/pose.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace prehend {
namespace {

Pose random_pose(Random& random) {
  return make_pose(random.normal3(1), Eigen::Quaterniond(random.normal(), random.normal(),
                                                         random.normal(), random.normal())
                                          .normalized());
}

TEST(Pose, RefusesWhatIsNoPose) {
  const double nan = std::nan("");
  EXPECT_FALSE(checked_pose({0, nan, 0}, Eigen::Quaterniond::Identity()));
  EXPECT_FALSE(checked_pose({0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 0)));
  EXPECT_FALSE(checked_pose({0, 0, 0}, Eigen::Quaterniond(nan, 0, 0, 1)));
  EXPECT_TRUE(checked_pose({0, 0, 0}, Eigen::Quaterniond(2, 0, 0, 0)));
  for (const auto& [diagonal, what] :
       {std::pair(0.0, "matrix is no rotation"), std::pair(-1.0, "matrix is a reflection"),
        std::pair(nan, "rotation is not finite")})
    EXPECT_EQ(nearest_rotation(diagonal * Eigen::Matrix3d::Identity()).error().what, what);
}

TEST(Pose, NearestRotationRepairsANoisyMatrix) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d R = random_pose(random).linear();
    Eigen::Matrix3d noisy = R;
    for (double& element : noisy.reshaped()) element += random.normal(0.01);
    const auto repaired = nearest_rotation(noisy);
    ASSERT_TRUE(repaired);
    EXPECT_NEAR((*repaired * repaired->transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
    // Nine elements of 0.01 noise turn it by a few hundredths of a radian at most.
    EXPECT_LT(angle_between(R, *repaired), 0.06);
  }
}

TEST(Pose, LimitedStepsReachTheGoalAndNeverExceedTheLimit) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    Pose X = random_pose(random);
    const Pose goal = random_pose(random);
    int steps = 0;
    while ((X.matrix() - goal.matrix()).norm() > 1e-9 && steps < 1000) {
      const Pose next = limit_step(X, goal, 0.05, 0.1);
      EXPECT_LE((next.translation() - X.translation()).norm(), 0.05 + 1e-12);
      EXPECT_LE(angle_between(X.linear(), next.linear()), 0.1 + 1e-7);
      X = next;
      ++steps;
    }
    EXPECT_LT(steps, 1000);
  }
}

}  // namespace
}  // namespace prehend
