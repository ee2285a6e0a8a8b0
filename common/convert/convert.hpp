#pragma once

#include <string>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"
#include "idl/Geometry.h"

/// Between messages and values. Reading checks what came from outside.
namespace prehend::convert {

v1::Vector3 to_message(const Eigen::Vector3d& v);
v1::Pose to_message(const Pose& X);
Eigen::Vector3d from_message(const v1::Vector3& v);
/// Refuses poses that are not finite or whose quaternion has no norm.
Expected<Pose> from_message(const v1::Pose& X);

/// Kinds that are not known here become `unknown`.
v1::ShapeKind to_message(model::ShapeKind kind);
model::ShapeKind from_message(v1::ShapeKind kind);

std::vector<double> to_message(const Eigen::VectorXd& v);
Eigen::VectorXd from_message(const std::vector<double>& v);

}  // namespace prehend::convert
