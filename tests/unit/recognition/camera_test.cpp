// Pixels and rays are inverse to each other, and silhouettes have the area that geometry gives
// them.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "common/base/random.hpp"
#include "services/recognition/core/geometry/silhouette.hpp"

namespace prehend::recognition {
namespace {

CameraModel above() {
  CameraModel camera;
  camera.X_WC = look_at({0, -0.75, 0.8}, {0, 0, 0});
  return camera;
}

TEST(Camera, RayOfAProjectedPointPassesThroughIt) {
  CameraModel camera = above();
  camera.distortion = {-0.1, 0.02, 0.001, -0.001, 0};
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.4, 0.4), random.uniform(-0.3, 0.4),
                            random.uniform(0, 0.2));
    const auto pixel = camera.project(p);
    ASSERT_TRUE(pixel);
    const auto back = camera.on_level(*pixel, p.z());
    ASSERT_TRUE(back);
    EXPECT_LT((*back - p).norm(), 1e-5);  // eight iterations of undistortion
  }
}

TEST(Camera, PointBehindHasNoPixelAndSkyNoLevel) {
  const CameraModel camera = above();
  EXPECT_FALSE(camera.project({0, -2, 2}));
  CameraModel level = camera;
  level.X_WC = look_at({0, -1, 0.5}, {0, 0, 0.5});
  EXPECT_FALSE(level.on_level({320, 10}, 0));
}

TEST(Camera, WrongCalibrationIsRefused) {
  CameraModel camera = above();
  EXPECT_TRUE(checked_camera(camera));
  camera.focal.x() = 0;
  EXPECT_FALSE(checked_camera(camera));
  camera = above();
  camera.distortion[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(checked_camera(camera));
}

TEST(Silhouette, OfABoxSeenFromAboveIsItsTop) {
  CameraModel camera;
  camera.X_WC =
      make_pose({0, 0, 1.0},
                Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix());
  const model::Shape box{model::ShapeKind::box, {0.2, 0.1, 0.04}};
  for (const double yaw : {0.0, 0.4, 1.2}) {
    const auto region = silhouette(camera, box, {0.02, 0.03, yaw});
    ASSERT_TRUE(region);
    const double scale = 620 / 0.96;  // px per metre at the height of the top
    // A pixel more or less along the rim of 0.6 m.
    EXPECT_NEAR(region->area(), 0.2 * 0.1 * scale * scale, 0.6 * scale);
  }
}

TEST(Silhouette, OutOfThePictureIsNone) {
  const model::Shape can{model::ShapeKind::cylinder, {0.03, 0.03, 0.1}};
  EXPECT_FALSE(silhouette(above(), can, {5, 0, 0}));
  EXPECT_FALSE(silhouette(above(), can, {0, -3, 0}));
}

}  // namespace
}  // namespace prehend::recognition
