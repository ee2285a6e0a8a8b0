#pragma once

#include <Eigen/Geometry>

#include "common/base/error.hpp"

namespace prehend {

/// A rigid transform; X_AB is the pose of frame B in frame A, so that X_AC = X_AB * X_BC.
using Pose = Eigen::Isometry3d;

Pose make_pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q);
Pose make_pose(const Eigen::Vector3d& p, const Eigen::Matrix3d& R = Eigen::Matrix3d::Identity());

/// A pose from numbers that came from outside: refuses what is not finite and rotations of (nearly)
/// zero norm, and normalises the rest.
Expected<Pose> checked_pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q);

/// The rotation nearest to a measured matrix (orthogonal Procrustes, by SVD). Fails on a matrix
/// that is not finite or is further than 0.2 in any singular value from a rotation.
Expected<Eigen::Matrix3d> nearest_rotation(const Eigen::Matrix3d& M);

bool is_finite(const Pose& X);

/// Angle of the rotation between two orientations, rad, in [0, pi].
double angle_between(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B);

/// From A (t = 0) to B (t = 1): positions straight, orientations along the shortest arc.
Pose interpolate(const Pose& A, const Pose& B, double t);

/// The pose nearest to B that is at most `distance` (m) and `angle` (rad) away from A.
Pose limit_step(const Pose& A, const Pose& B, double distance, double angle);

}  // namespace prehend
