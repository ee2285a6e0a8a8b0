#pragma once

#include <Eigen/Core>

#include "common/model/shape.hpp"

namespace prehend::analysis {

/// Skewness of an approach: its angle to the nearest principal axis of the object, rad, 0 to
/// acos(1/√3). People align their hand with the object's axes (Balasubramanian, Xu, Brook, Smith &
/// Matsuoka, Physical human interactive guidance, T-RO 28(4), 2012). Where two principal moments
/// are equal (a cylinder) every axis in their plane is principal, so 0 across a cylinder.
/// second_moments_O: ∫ x xᵀ dV or the covariance of the surface, symmetric; approach_O: not zero.
double skewness(const Eigen::Matrix3d& second_moments_O, const Eigen::Vector3d& approach_O);
double skewness(const model::Shape& shape, const Eigen::Vector3d& approach_O);

}  // namespace prehend::analysis
