#pragma once

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::performer {

/// How far an object is turned from how it shall lie, as far as that shows, rad: of a sphere
/// nothing shows, of a cylinder where its axis points, of a box all but half turns.
double visible_turn(const model::Shape& shape, const Eigen::Matrix3d& R,
                    const Eigen::Matrix3d& goal);

/// The pose nearest to X_WO of those that look like the goal.
Pose nearest_alike(const model::Shape& shape, const Pose& goal, const Pose& X_WO);

}  // namespace prehend::performer
