#pragma once

#include <optional>
#include <vector>

#include "common/model/shape.hpp"
#include "services/recognition/core/geometry/camera_model.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// The region of a picture that a convex solid covers: from row `top` on, columns [left, right) of
/// each row, clipped to the picture; empty rows have right <= left.
struct Silhouette {
  struct Span {
    int left = 0, right = 0;
  };
  int top = 0;
  std::vector<Span> rows;

  int area() const;  // px
  /// Sets its pixels in a plane of the picture's size.
  void mark(Plane& plane, std::uint8_t value) const;
};

/// Where an object stands on the table: centre of its base and turn about the vertical.
struct TablePose {
  double x = 0, y = 0;  // m, in W
  double yaw = 0;       // rad
};

/// Pose of a standing object's centre.
Pose standing_pose(const model::Shape& shape, const TablePose& at);

/// Silhouette of a shape grown by `margin` (m) on all sides but the base. None when it is behind
/// the camera or fills no pixel of the picture.
std::optional<Silhouette> silhouette(const CameraModel& camera, const model::Shape& shape,
                                     const TablePose& at, double margin = 0);

/// Corners of the convex polygon around a shape in the picture, in px; none behind the camera.
std::optional<std::vector<Eigen::Vector2d>> outline(const CameraModel& camera,
                                                    const model::Shape& shape, const TablePose& at,
                                                    double margin = 0);

}  // namespace prehend::recognition
