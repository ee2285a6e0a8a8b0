#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::planner {

/// One flat piece of a surface with the normals of the surface it stands for, m.
struct Triangle {
  Eigen::Vector3d p[3];
  Eigen::Vector3d n[3];  // unit, outward
  int paint = 0;         // index into the paints of a drawing
};

/// The surface of a primitive at X_W, in W.
std::vector<Triangle> surface_of(const model::Shape& shape, const Pose& X_WS, int paint);

/// A cone from its apex along a unit axis, with the given half angle and length, closed at its end.
std::vector<Triangle> cone(const Eigen::Vector3d& apex_W, const Eigen::Vector3d& axis_W,
                           double half_angle, double length, int paint);

}  // namespace prehend::planner
