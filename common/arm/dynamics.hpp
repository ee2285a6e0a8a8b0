#pragma once

#include "common/arm/kinematics.hpp"

namespace prehend::arm {

/// What hangs at the arm's last link, in its frame L, and what pushes there.
struct Burden {
  double mass = 0;                                     // kg, of the hand
  Eigen::Vector3d com_L = Eigen::Vector3d::Zero();     // m
  Eigen::Vector3d p_L = Eigen::Vector3d::Zero();       // m, where the force below acts
  Eigen::Vector3d force_A = Eigen::Vector3d::Zero();   // N, of what the hand touches or carries
  Eigen::Vector3d torque_A = Eigen::Vector3d::Zero();  // N m, of the same
};

/// What the drives of the joints must give, N m, so that the arm moves like that: weights and
/// inertias of its links, of the hand as a point, and what pushes there. Newton and Euler's
/// equations from the base to the end and back. Friction and the drives' own inertia are not in.
/// gravity_A: m/s².
Joints drive_torques(const model::ArmModel& arm, const Joints& q, const Joints& velocity,
                     const Joints& acceleration, const Burden& burden,
                     const Eigen::Vector3d& gravity_A);

/// Greatest force (N, in any direction at p_L) and greatest torque (N m, about any axis) that the
/// drives can give beside `torques`, which they give already.
struct Strength {
  double force = 0, torque = 0;
};
Strength strength_left(const model::ArmModel& arm, const Joints& q, const Joints& torques,
                       const Eigen::Vector3d& p_L);

}  // namespace prehend::arm
