#pragma once

#include "services/recognition/core/placing/evidence.hpp"

namespace prehend::recognition {

/// Covariance of x, y (m) and yaw (rad) of a shape that stands where the evidence in its outline is
/// greatest, from the curvature there. Neighbouring pixels repeat each other, so evidence counts
/// for a tenth; 0.6 mm and a quarter of a degree are the least that is claimed (errors in rendered
/// scenes, see prehend objects scenes). Says nothing of an error of the camera's calibration.
Eigen::Matrix3d covariance(const Evidence& evidence, const CameraModel& camera,
                           const model::Shape& shape, const TablePose& at);

/// Width and height with which the outline holds most evidence, each by itself, as shares of those
/// that the shape has; 0.67 to 1.5 in steps of 5 %.
Eigen::Vector2d measured_size(const Evidence& evidence, const CameraModel& camera,
                              const model::Shape& shape, const TablePose& at);

}  // namespace prehend::recognition
