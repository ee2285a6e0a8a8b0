#pragma once

#include <array>
#include <optional>

#include "common/base/pose.hpp"

namespace prehend::recognition {

/// A calibrated camera. Frame C: z into the scene, x right, y down; W: the table, z up.
struct CameraModel {
  int width = 640, height = 480;            // px
  Eigen::Vector2d focal = {620, 620};       // px
  Eigen::Vector2d centre = {319.5, 239.5};  // px, principal point
  std::array<double, 5> distortion = {};    // k1 k2 p1 p2 k3, as OpenCV
  Pose X_WC = Pose::Identity();

  /// Pixel of a point, none if it lies less than 5 cm in front of the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_W) const;
  /// Unit direction in W of the light that falls on a pixel.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;
  /// Where the pixel's ray meets the level z = height; none if it never does in front of the
  /// camera.
  std::optional<Eigen::Vector3d> on_level(const Eigen::Vector2d& pixel, double height) const;
  /// The same camera for a picture scaled by a factor.
  CameraModel scaled(double factor) const;
};

/// Checks sizes, finiteness and the pose.
Expected<CameraModel> checked_camera(const CameraModel& camera);

/// A camera at p_W that looks at a point, its x axis level.
Pose look_at(const Eigen::Vector3d& p_W, const Eigen::Vector3d& target_W);

}  // namespace prehend::recognition
