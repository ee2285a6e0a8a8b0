#pragma once

#include <Eigen/Geometry>

#include "common/base/pose.hpp"

namespace prehend::glove {

/// Position of a sensor relative to the reference sensor on the back of the hand, p = Mᵀ (x − x_r)
/// [Thesis, eq. 4.1]: the same wherever the hand is and however it is turned. M and x_r are
/// rotation and position of the reference, X_TR; x that of the other sensor. m.
Eigen::Vector3d invariant_feature(const Pose& X_TR, const Eigen::Vector3d& p_TS);

}  // namespace prehend::glove
