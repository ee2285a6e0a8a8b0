#include "common/arm/dynamics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace prehend::arm {
namespace {

/// Of a link, in A.
struct LinkMotion {
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();       // rad/s
  Eigen::Vector3d turning_more = Eigen::Vector3d::Zero();  // rad/s²
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s², of the link's origin
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         // that it needs
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();        // about its origin
};

/// Acceleration of a point of the link, which is r_A from its origin.
Eigen::Vector3d acceleration_at(const LinkMotion& link, const Eigen::Vector3d& r_A) {
  return link.acceleration + link.turning_more.cross(r_A) +
         link.turning.cross(link.turning.cross(r_A));
}

void add_force(LinkMotion& link, const Eigen::Vector3d& r_A, const Eigen::Vector3d& force) {
  link.force += force;
  link.torque += r_A.cross(force);
}

}  // namespace

Joints drive_torques(const model::ArmModel& arm, const Joints& q, const Joints& velocity,
                     const Joints& acceleration, const Burden& burden,
                     const Eigen::Vector3d& gravity_A) {
  const Configuration at = forward(arm, q);
  const std::size_t count = arm.joints.size();
  std::array<LinkMotion, model::max_arm_joints + 1> motions;
  motions[0].acceleration = -gravity_A;  // as if all were pulled up
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const LinkMotion& before = motions[i];
    LinkMotion& now = motions[i + 1];
    const Eigen::Matrix3d R_AL = at.X_AL[i + 1].linear();
    const Eigen::Vector3d axis = R_AL * arm.joints[i].axis_J;
    now.acceleration =
        acceleration_at(before, at.X_AL[i + 1].translation() - at.X_AL[i].translation());
    now.turning = before.turning + axis * velocity[k];
    now.turning_more =
        before.turning_more + axis * acceleration[k] + before.turning.cross(axis * velocity[k]);
    const model::ArmLink& link = arm.links[i + 1];
    const Eigen::Vector3d r = R_AL * link.com_L;
    const Eigen::Matrix3d inertia = R_AL * link.inertia_L * R_AL.transpose();
    add_force(now, r, link.mass * acceleration_at(now, r));
    now.torque += inertia * now.turning_more + now.turning.cross(inertia * now.turning);
  }
  LinkMotion& last = motions[count];
  const Eigen::Matrix3d R_AL = at.X_AL[count].linear();
  const Eigen::Vector3d hand = R_AL * burden.com_L;
  add_force(last, hand, burden.mass * acceleration_at(last, hand));
  add_force(last, R_AL * burden.p_L, -burden.force_A);
  last.torque -= burden.torque_A;

  Joints torques = Joints::Zero(static_cast<Eigen::Index>(count));
  for (std::size_t i = count; i > 0; --i) {
    const Pose& X_AL = at.X_AL[i];
    torques[static_cast<Eigen::Index>(i - 1)] =
        (X_AL.linear() * arm.joints[i - 1].axis_J).dot(motions[i].torque);
    add_force(motions[i - 1], X_AL.translation() - at.X_AL[i - 1].translation(), motions[i].force);
    motions[i - 1].torque += motions[i].torque;
  }
  return torques;
}

Strength strength_left(const model::ArmModel& arm, const Joints& q, const Joints& torques,
                       const Eigen::Vector3d& p_L) {
  const Configuration at = forward(arm, q);
  const Eigen::Vector3d p_A = at.X_AL[arm.joints.size()] * p_L;
  Strength left{1e9, 1e9};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    if (!(arm.joints[i].max_torque > 0)) continue;  // nobody says
    const Pose& X_AL = at.X_AL[i + 1];
    const double spare =
        std::max(0.0, arm.joints[i].max_torque - std::abs(torques[static_cast<Eigen::Index>(i)]));
    const double lever =
        (X_AL.linear() * arm.joints[i].axis_J).cross(p_A - X_AL.translation()).norm();
    left.force = std::min(left.force, spare / std::max(lever, 1e-3));
    left.torque = std::min(left.torque, spare);
  }
  return left;
}

}  // namespace prehend::arm
