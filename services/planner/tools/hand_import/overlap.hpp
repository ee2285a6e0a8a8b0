#pragma once

#include <vector>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::planner {

/// Points on a shape's surface, a grid of about ten by ten a face, in the shape's frame.
std::vector<Eigen::Vector3d> surface_points(const model::Shape& shape);

/// How deep shape B reaches into shape A, m, at most 0 when they are apart: by the points of each
/// in the other, so it may miss what two crossing bars share.
double overlap(const model::Shape& A, const Pose& X_WA, const model::Shape& B, const Pose& X_WB);

}  // namespace prehend::planner
