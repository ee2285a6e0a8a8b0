#include "common/model/hand_model.hpp"

#include <algorithm>

namespace prehend::model {

using Eigen::Vector3d;
using Eigen::VectorXd;

double radian_of(const HandDof& dof) {
  return dof.kind == JointKind::prismatic ? dof.squeeze / full_squeeze : 1.0;
}

Eigen::VectorXd HandModel::joint_angles(const Eigen::VectorXd& dof) const {
  VectorXd q(static_cast<Eigen::Index>(joints_.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const HandJoint& joint = joints_[static_cast<std::size_t>(i)];
    q[i] = joint.multiplier * dof[joint.dof] + joint.offset;
  }
  return q;
}

Eigen::VectorXd HandModel::clamp(const Eigen::VectorXd& dof) const {
  VectorXd clamped = dof;
  for (Eigen::Index i = 0; i < clamped.size(); ++i) {
    const HandDof& limits = dofs_[static_cast<std::size_t>(i)];
    clamped[i] = std::clamp(clamped[i], limits.lower, limits.upper);
  }
  return clamped;
}

std::vector<Pose> HandModel::link_poses(const Eigen::VectorXd& joint_angles) const {
  std::vector<Pose> X_BL(links_.size(), Pose::Identity());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const HandJoint& joint = joints_[i];
    const double q = joint_angles[static_cast<Eigen::Index>(i)];
    Pose& X_BC = X_BL[static_cast<std::size_t>(joint.child)];
    X_BC = X_BL[static_cast<std::size_t>(joint.parent)] * joint.X_PJ;
    if (joint.kind == JointKind::revolute)
      X_BC.rotate(Eigen::AngleAxisd(q, joint.axis_J));
    else
      X_BC.translate(q * joint.axis_J);
  }
  return X_BL;
}

std::vector<Eigen::Vector3d> HandModel::fingertip_positions(const Eigen::VectorXd& dof) const {
  const std::vector<Pose> X_BL = link_poses(joint_angles(dof));
  std::vector<Vector3d> tips;
  for (const HandFingertip& tip : fingertips_)
    tips.push_back(X_BL[static_cast<std::size_t>(tip.link)] * tip.p_LT);
  return tips;
}

}  // namespace prehend::model
