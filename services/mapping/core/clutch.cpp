#include "services/mapping/core/clutch.hpp"

#include <algorithm>

namespace prehend::mapping {

void Clutch::hold(const Pose& X_WG, const Pose& X_WG_robot) {
  is_held_ = true;
  offset_ = make_pose(X_WG_robot.translation() - X_WG.translation(),
                      Eigen::Matrix3d(X_WG_robot.linear() * X_WG.linear().transpose()));
}

void Clutch::hold(const Eigen::VectorXd& dof, const Eigen::VectorXd& dof_robot) {
  dof_offset_ = dof_robot - dof;
}

void Clutch::fade(Duration elapsed) {
  const double t = to_seconds(elapsed);
  if (is_held_) {
    offset_ = limit_step(offset_, Pose::Identity(), options_.speed * t, options_.turn_speed * t);
    is_held_ = offset_.matrix() != Pose::Identity().matrix();
  }
  for (Eigen::Index i = 0; i < dof_offset_.size(); ++i) {
    const double step =
        options_.finger_speed * radian_of(hand_.dofs()[static_cast<std::size_t>(i)]) * t;
    dof_offset_[i] -= std::clamp(dof_offset_[i], -step, step);
  }
  if (dof_offset_.size() > 0 && dof_offset_.isZero(0)) dof_offset_.resize(0);
}

Pose Clutch::X_WG(const Pose& X_WG) const {
  if (!is_held_) return X_WG;
  return make_pose(X_WG.translation() + offset_.translation(),
                   Eigen::Matrix3d(offset_.linear() * X_WG.linear()));
}

Eigen::VectorXd Clutch::dof(const Eigen::VectorXd& dof) const {
  if (dof_offset_.size() == 0) return dof;
  return dof + dof_offset_;
}

bool Clutch::is_jump(const Pose& from, const Pose& to) const {
  return (to.translation() - from.translation()).norm() > options_.jump ||
         angle_between(from.linear(), to.linear()) > options_.turned;
}

}  // namespace prehend::mapping
