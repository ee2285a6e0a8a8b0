#include <utility>

#include "common/model/hand_model.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;

Vector3d mirrored(const Vector3d& v) {
  return {-v.x(), v.y(), v.z()};
}

/// S M S with the reflection S = diag(-1, 1, 1).
Eigen::Matrix3d mirrored(Eigen::Matrix3d M) {
  for (const int i : {1, 2}) {
    M(0, i) = -M(0, i);
    M(i, 0) = -M(i, 0);
  }
  return M;
}

Pose mirrored(const Pose& X) {
  return make_pose(mirrored(Vector3d(X.translation())), mirrored(Eigen::Matrix3d(X.linear())));
}

}  // namespace

HandModel HandModel::mirrored() const {
  HandModel mirror = *this;
  std::swap(mirror.name_, mirror.mirror_name_);
  for (HandLink& link : mirror.links_) {
    link.com_L = model::mirrored(link.com_L);
    link.inertia_L = model::mirrored(link.inertia_L);
    // The solids are their own mirror images.
    for (CollisionShape& part : link.collision) part.X_LS = model::mirrored(part.X_LS);
  }
  for (HandJoint& joint : mirror.joints_) {
    joint.X_PJ = model::mirrored(joint.X_PJ);
    joint.axis_J = model::mirrored(joint.axis_J);
    // What turns one way turns the other way in a mirror.
    if (joint.kind == JointKind::revolute) joint.axis_J = -joint.axis_J;
  }
  for (HandFingertip& tip : mirror.fingertips_) tip.p_LT = model::mirrored(tip.p_LT);
  mirror.X_BG_ = model::mirrored(X_BG_);
  return mirror;
}

}  // namespace prehend::model
