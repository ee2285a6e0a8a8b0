#pragma once

#include "common/base/pose.hpp"

namespace prehend::grasping {

/// What carries the hand: limits of its base.
struct ArmLimits {
  double speed = 1.0;               // m/s, at which the base moves at most
  double turn_speed = 3.0;          // rad/s, at which it turns at most
  double acceleration = 10.0;       // m/s², by which it becomes faster or slower at most
  double turn_acceleration = 50.0;  // rad/s², by which its turn does
};

/// How hard it may brake when it is told to stop at once: harder than on its way.
struct BrakeLimits {
  double acceleration = 20.0;        // m/s², by which the base brakes
  double turn_acceleration = 100.0;  // rad/s², by which its turn does
};

/// The hand's base as a body. As heavy as this, whatever the hand touches is lost in its inertia.
struct BaseBody {
  double mass = 1000;    // kg
  double inertia = 100;  // kg m²
};

/// What an arm can push the base with, N and N m.
struct Push {
  double force = 0, torque = 0;
};

/// What pushes against the base, in W: N, and N m about its centre of mass.
struct BaseLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// The base's velocity on its way to where it was told to be: fast, within the limits, hardly any
/// overshoot (1 mm at 500 Hz). A value: two with the same history move alike.
class Arm {
 public:
  /// The velocities of the next step of `dt` s, from X_WC (now) towards X_WC_goal, which itself
  /// moves at goal_velocity (m/s, in W).
  void step(const Pose& X_WC, const Pose& X_WC_goal, const Eigen::Vector3d& goal_velocity,
            const ArmLimits& limits, double dt);
  void stop() { *this = {}; }
  /// So the base moves now, whatever it was told: something holds it up.
  void feel(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning);

  const Eigen::Vector3d& velocity() const { return velocity_; }  // m/s, in W
  const Eigen::Vector3d& turning() const { return turning_; }    // rad/s, in W

 private:
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d turning_ = Eigen::Vector3d::Zero();
};

}  // namespace prehend::grasping
