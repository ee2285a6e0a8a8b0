#include "arm.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;

constexpr double gain = 25;  // 1/s, of the position loop

/// Speed that reaches `distance` soonest without overshoot, within the limits.
double approach_speed(double distance, double speed, double acceleration) {
  return std::min({gain * distance, std::sqrt(2 * acceleration * distance), speed});
}

/// The velocity of the next step towards `error`, from `velocity`.
Vector3d follow(const Vector3d& error, const Vector3d& velocity, double speed, double acceleration,
                double dt) {
  const double distance = error.norm();
  Vector3d wanted = Vector3d::Zero();
  if (distance > 1e-12) wanted = approach_speed(distance, speed, acceleration) / distance * error;
  const Vector3d change = wanted - velocity;
  const double most = acceleration * dt;
  return change.norm() <= most ? wanted : Vector3d(velocity + most * change.normalized());
}

}  // namespace

void Arm::step(const Pose& X_WC, const Pose& X_WC_goal, const ArmLimits& limits, double dt) {
  const Vector3d move = X_WC_goal.translation() - X_WC.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(X_WC_goal.linear() * X_WC.linear().transpose()));
  velocity_ = follow(move, velocity_, limits.speed, limits.acceleration, dt);
  turning_ =
      follow(turn.angle() * turn.axis(), turning_, limits.turn_speed, limits.turn_acceleration, dt);
}

}  // namespace prehend::grasping
