#include "common/grasping/carrier.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {
namespace {

Eigen::Vector3d turn_between(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  return turn.angle() * turn.axis();
}

/// The next velocity beside the arm of what is `behind` it: back so fast that it can still stop
/// there, gained within the acceleration.
Eigen::Vector3d come_back(const Eigen::Vector3d& behind, const Eigen::Vector3d& beside,
                          double acceleration, double dt) {
  const double distance = behind.norm();
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (distance > 0)
    wanted = behind * (std::min(distance / dt, std::sqrt(acceleration * distance)) / distance);
  Eigen::Vector3d change = wanted - beside;
  const double most = acceleration * dt;
  if (change.norm() > most) change *= most / change.norm();
  return beside + change;
}

}  // namespace

void Carrier::aim(const Pose& X_WC, const Push& most) {
  aim_ = X_WC;
  push_ = most;
}

void Carrier::step(const Pose& X_WC, const Eigen::Vector3d& velocity,
                   const Eigen::Vector3d& turning, const BaseBody& base, double dt) {
  if (!X_WC_) X_WC_ = X_WC;
  const Eigen::Vector3d beside = come_back(X_WC_->translation() - X_WC.translation(),
                                           velocity - arm_velocity_, push_.force / base.mass, dt);
  const Eigen::Vector3d turned = come_back(turn_between(X_WC, *X_WC_), turning - arm_turning_,
                                           push_.torque / base.inertia, dt);
  arm_velocity_ = (aim_->translation() - X_WC_->translation()) / dt;
  arm_turning_ = turn_between(*X_WC_, *aim_) / dt;
  velocity_ = arm_velocity_ + beside;
  turning_ = arm_turning_ + turned;
  X_WC_ = aim_;
}

BaseLoad Carrier::load(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning,
                       const BaseBody& base, double dt) const {
  return {base.mass / dt * (velocity - velocity_), base.inertia / dt * (turning - turning_)};
}

}  // namespace prehend::grasping
