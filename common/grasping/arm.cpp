#include "common/grasping/arm.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;

constexpr double gain = 25;  // 1/s, of the position loop

/// Speed that reaches `distance` soonest within the limits and can still brake.
double approach_speed(double distance, double speed, double acceleration) {
  return std::min({gain * distance, std::sqrt(2 * acceleration * distance), speed});
}

/// The velocity of the next step towards what is `error` away and moves itself, from `velocity`.
Vector3d follow(const Vector3d& error, const Vector3d& goal_velocity, const Vector3d& velocity,
                double speed, double acceleration, double dt) {
  const double distance = error.norm();
  Vector3d wanted = goal_velocity;
  if (distance > 1e-12) wanted += approach_speed(distance, speed, acceleration) / distance * error;
  if (wanted.norm() > speed) wanted *= speed / wanted.norm();
  const Vector3d change = wanted - velocity;
  const double most = acceleration * dt;
  return change.norm() <= most ? wanted : Vector3d(velocity + most * change.normalized());
}

}  // namespace

void Arm::step(const Pose& X_WC, const Pose& X_WC_goal, const Vector3d& goal_velocity,
               const ArmLimits& limits, double dt) {
  const Vector3d move = X_WC_goal.translation() - X_WC.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(X_WC_goal.linear() * X_WC.linear().transpose()));
  velocity_ = follow(move, goal_velocity, velocity_, limits.speed, limits.acceleration, dt);
  turning_ = follow(turn.angle() * turn.axis(), Vector3d::Zero(), turning_, limits.turn_speed,
                    limits.turn_acceleration, dt);
}

void Arm::feel(const Vector3d& velocity, const Vector3d& turning) {
  velocity_ = velocity;
  turning_ = turning;
}

}  // namespace prehend::grasping
