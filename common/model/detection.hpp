#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// An object as object/detection says it.
struct Detection {
  std::uint32_t track = 0;  // stays the same while the object is tracked
  std::string name;
  Shape shape;
  Pose X_WO = Pose::Identity();
  double probability = 0;
  Time stamp;  // of the picture that shows it
  /// Of x, y, z (m) and the turn about z (rad); zero: exact.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

}  // namespace prehend::model
