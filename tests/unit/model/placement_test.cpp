// Where a hand goes to grasp a standing object. For every object of the catalogue and random hands:
// the answer is a rigid frame, closes across something that fits, does not reach below the table,
// and is a fixed point (the nearest grasp to a grasp is itself).
#include "common/model/placement.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "common/model/catalogue.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;

TEST(Placement, PropertiesOverAllCatalogueObjects) {
  const auto catalogue = Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  ASSERT_TRUE(catalogue) << catalogue.error().message();
  EXPECT_EQ(catalogue->objects().size(), 9u);
  Random random(3);
  for (const CatalogueObject& object : catalogue->objects()) {
    const Vector3d half = half_extents(object.shape);
    for (int i = 0; i < 200; ++i) {
      // Every other hand has fingers of its own length.
      Reach reach;
      if (i % 2 == 1) reach.clearance = random.uniform(0.02, 0.2);
      const Pose X_OG = make_pose(
          random.normal3(0.1),
          Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
              .normalized());
      const auto grasp = nearest_grasp(object.shape, X_OG, reach);
      // What is lower than the fingers need can only be had from the side.
      if (!grasp) {
        EXPECT_GT(reach.clearance, 2 * half.z()) << object.name;
        continue;
      }
      const Eigen::Matrix3d R = grasp->linear();
      EXPECT_NEAR((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
      EXPECT_NEAR(R.determinant(), 1, 1e-12);
      const Vector3d p = grasp->translation();
      const bool from_above = R(2, 2) < -0.7;
      EXPECT_GE(p.z() + half.z(), (from_above ? reach.clearance : reach.half_width) - 1e-12)
          << object.name << " below the table";
      EXPECT_LE(p.z(), half.z() + 1e-3) << object.name << " above the object";
      EXPECT_LE(R.col(2).z(), 1e-12) << object.name << " approached from below";
      // The width between the faces that the fingers close on.
      const Vector3d y = R.col(1);
      const double width = object.shape.kind == ShapeKind::cylinder ? 2 * object.shape.size.x()
                           : std::abs(y.x()) > 0.5                  ? object.shape.size.x()
                                                                    : object.shape.size.y();
      EXPECT_LE(width, reach.opening) << object.name;
      // The fingers close centred on those faces.
      EXPECT_NEAR(p.dot(y), 0, 1e-9) << object.name;
      const auto again = nearest_grasp(object.shape, *grasp, reach);
      ASSERT_TRUE(again);
      EXPECT_NEAR((again->matrix() - grasp->matrix()).norm(), 0, 1e-9) << object.name;
    }
  }
}

TEST(Placement, ACylinderKeepsTheSideFromWhichItIsApproached) {
  const Shape cup{ShapeKind::cylinder, {0.033, 0.033, 0.2}};
  for (double azimuth = -3; azimuth < 3; azimuth += 0.5) {
    const Vector3d approach(std::cos(azimuth), std::sin(azimuth), 0);
    Eigen::Matrix3d R;
    R << Vector3d::UnitZ(), approach.cross(Vector3d::UnitZ()), approach;
    const auto grasp = nearest_grasp(cup, make_pose(Vector3d(-0.05 * approach), R), Reach{});
    ASSERT_TRUE(grasp);
    EXPECT_NEAR((grasp->linear() - R).norm(), 0, 1e-9);
    EXPECT_NEAR(grasp->translation().head<2>().norm(), 0, 1e-12);
  }
}

TEST(Placement, NothingFitsAroundWhatIsTooLarge) {
  EXPECT_FALSE(nearest_grasp({ShapeKind::cylinder, {0.2, 0.2, 0.3}}, Pose::Identity(), Reach{}));
  EXPECT_FALSE(nearest_grasp({ShapeKind::box, {0.2, 0.2, 0.3}}, Pose::Identity(), Reach{}));
  EXPECT_FALSE(nearest_grasp({ShapeKind::unknown, {1, 1, 1}}, Pose::Identity(), Reach{}));
}

TEST(Placement, AConeIsHeldWhereTheOpeningAdmitsIt) {
  const Reach reach;
  const Pose from_above =
      make_pose(Vector3d::Zero(), grasp_axes(-Vector3d::UnitZ(), Vector3d::UnitY()));
  const Pose from_side =
      make_pose(Vector3d::Zero(), grasp_axes(Vector3d::UnitX(), Vector3d::UnitY()));
  // Wider below than the hand opens: from above and from the side only where it is narrow enough.
  const Shape tent{ShapeKind::cone, {0.09, 0.02, 0.25}};
  for (const Pose& X_OG : {from_above, from_side}) {
    const auto grasp = nearest_grasp(tent, X_OG, reach);
    ASSERT_TRUE(grasp);
    EXPECT_LT(angle_between(grasp->linear(), X_OG.linear()), 1e-9);
    EXPECT_LE(2 * radius_at(tent, grasp->translation().z()), reach.opening + 1e-9);
  }
  // The same upside down: fingers from above would have to pass the wide rim.
  const Shape funnel{ShapeKind::cone, {0.02, 0.09, 0.25}};
  const auto grasp = nearest_grasp(funnel, from_above, reach);
  ASSERT_TRUE(grasp);
  EXPECT_LT(std::abs(grasp->linear()(2, 2)), 1e-9);
  EXPECT_LE(2 * radius_at(funnel, grasp->translation().z()), reach.opening + 1e-9);
  // With equal radii it is a cylinder.
  for (const Pose& X_OG : {from_above, from_side})
    EXPECT_LT((nearest_grasp({ShapeKind::cone, {0.03, 0.03, 0.2}}, X_OG, reach)->matrix() -
               nearest_grasp({ShapeKind::cylinder, {0.03, 0.03, 0.2}}, X_OG, reach)->matrix())
                  .norm(),
              1e-12);
}

}  // namespace
}  // namespace prehend::model
