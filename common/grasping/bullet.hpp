#pragma once

#include <LinearMath/btTransform.h>

#include "common/base/pose.hpp"

/// Between Eigen's values and Bullet's.
namespace prehend::grasping {

inline btVector3 to_bullet(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

inline btQuaternion to_bullet(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {q.x(), q.y(), q.z(), q.w()};
}

inline btTransform to_bullet(const Pose& X) {
  return btTransform(to_bullet(Eigen::Matrix3d(X.linear())),
                     to_bullet(Eigen::Vector3d(X.translation())));
}

inline Eigen::Vector3d from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

inline Pose from_bullet(const btTransform& X) {
  const btQuaternion q = X.getRotation();
  return make_pose(from_bullet(X.getOrigin()),
                   Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized());
}

}  // namespace prehend::grasping
