#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/arm_model.hpp"

namespace prehend::arm {

/// Values of all joints, rad. Kept without allocation.
using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, model::max_arm_joints, 1>;
/// Velocity of E in A over velocities of the joints: three rows m/s, three rad/s.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, model::max_arm_joints>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// X_AL of every link, of E, and how E moves with the joints.
struct Configuration {
  std::array<Pose, model::max_arm_joints + 1> X_AL;
  Pose X_AE;
};

Configuration forward(const model::ArmModel& arm, const Joints& q);
Pose end_pose(const model::ArmModel& arm, const Joints& q);
Jacobian jacobian(const model::ArmModel& arm, const Configuration& at);

/// What takes A to B, in the frame in which both are told: m, and the rotation as a vector, rad.
Vector6 way_between(const Pose& A, const Pose& B);

/// Farthest that E can be from S, m: an upper bound by the lengths of the links.
double reach_bound(const model::ArmModel& arm);

bool is_within_limits(const model::ArmModel& arm, const Joints& q);

/// The same posture with every joint in its limits where a whole number of turns brings it there,
/// as near to 0 as that allows; else in (-π, π].
Joints turned_into_limits(const model::ArmModel& arm, const Joints& q);

/// All of the posture's values within the limits that differ by whole turns, `q` first if it is
/// within them.
std::vector<Joints> turns_within_limits(const model::ArmModel& arm, const Joints& q);

/// The angle in (-π, π] that differs by whole turns.
double wrapped(double angle);

}  // namespace prehend::arm
