#pragma once

#include <optional>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// Grasp frame G of any hand, human or robot: origin in the middle of the closing fingers, z out of
/// the palm (the approach), y the way the fingers close, from the thumb's side to the fingers',
/// x = y × z. Two hands are aligned when their grasp frames coincide.

/// What a hand needs around an object, in its grasp frame. m.
struct Reach {
  double opening = 0.11;      // widest object between thumb and fingers
  double engage = 0.04;       // how far the origin of G goes below the surface that is approached
  double clearance = 0.04;    // least height of the origin of G above the table, from above
  double half_width = 0.055;  // the same from the side: half the palm's width along x and some air
};

/// Axes of a grasp frame from its approach (z) and closing direction (y), both unit and at right
/// angles.
Eigen::Matrix3d grasp_axes(const Eigen::Vector3d& approach, const Eigen::Vector3d& closing);

/// The grasp frame nearest to X_OG among those from which a standing object can be grasped:
/// cylinders, cones and boxes from above if they are as high as the clearance, cylinders and cones
/// taller than the palm from any side where the opening admits them, boxes across any pair of faces
/// that fits into the opening. Freedoms that do not matter (turn about a cylinder, place along a
/// long side) keep the values of X_OG. None if nothing fits. «Nearest» minimises the angle first.
std::optional<Pose> nearest_grasp(const Shape& shape, const Pose& X_OG, const Reach& reach);

}  // namespace prehend::model
