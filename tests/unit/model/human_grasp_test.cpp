// How a synthetic person comes at things: cylinders from where they stand, boxes from above.
#include "common/model/human_grasp.hpp"

#include <gtest/gtest.h>

namespace prehend::model {
namespace {

using Eigen::Vector3d;

TEST(HumanGrasp, CylindersFromTheSideThePersonComesFrom) {
  const Shape can{ShapeKind::cylinder, {0.03, 0.03, 0.2}};
  Demonstrator person;
  for (const double yaw : {-1.5, 0.0, 2.0}) {
    person.grasp_yaw = yaw;
    const Pose X_WO = make_pose({0.1, 0.2, 0.1});
    const auto X_OG = human_grasp(can, X_WO, person);
    ASSERT_TRUE(X_OG);
    const Vector3d approach = (X_WO * *X_OG).linear().col(2);
    EXPECT_NEAR((approach - Vector3d(-std::cos(yaw), -std::sin(yaw), 0)).norm(), 0, 1e-9);
  }
}

TEST(HumanGrasp, BoxesFromAboveAcrossTheirDepthFingersOnTheFarSide) {
  const Shape box{ShapeKind::box, {0.05, 0.12, 0.1}};
  for (const double turn : {0.0, 1.0, 3.0}) {
    const Pose X_WO = make_pose(
        {0, 0, 0.05}, Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * Eigen::Matrix3d::Identity());
    const auto X_OG = human_grasp(box, X_WO, {});
    ASSERT_TRUE(X_OG);
    const Pose X_WG = X_WO * *X_OG;
    EXPECT_NEAR(X_WG.linear()(2, 2), -1, 1e-9) << "the palm looks down";
    EXPECT_NEAR(std::abs(X_OG->linear().col(1).x()), 1, 1e-9) << "fingers close across its depth";
    EXPECT_GE(X_WG.linear().col(1).y(), -1e-9) << "fingers are on the far side";
  }
}

TEST(HumanGrasp, NoneOfWhatIsTooWide) {
  EXPECT_FALSE(human_grasp({ShapeKind::cylinder, {0.2, 0.2, 0.2}}, make_pose({0, 0, 0.1}), {}));
}

}  // namespace
}  // namespace prehend::model
