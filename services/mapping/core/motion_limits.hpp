#pragma once

#include <Eigen/Core>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/finger_collision_limiter.hpp"

namespace prehend::mapping {

struct MotionLimitOptions {
  /// A finger that closes on a known object moves at most this fast, rad/s, or what radian_of()
  /// makes of it; any other finger keeps only the limit of its joint.
  double closing_speed = 1.0;
  /// The hand's base moves at most this fast, m/s.
  double base_speed = 1.0;
  /// The hand's base turns at most this fast, rad/s.
  double base_turn_speed = 3.0;
  /// After a pause of any length, one command moves as far as in this time.
  Duration max_step = std::chrono::milliseconds(100);
};

/// How far one command may go from the one before. Pure: it remembers nothing but the hand. Keeps a
/// reference to the hand.
class MotionLimits {
 public:
  MotionLimits(const model::HandModel& hand, const MotionLimitOptions& options)
      : hand_(hand), options_(options), collisions_(hand) {}

  /// What counts of the time since the last command: 0 to max_step.
  Duration step(Duration since) const;

  /// DoF values, rad or m, on the way from `before` to `goal`. together: how much, 0 to 1, the
  /// fingers close in proportion and slowly enough to arrive together, since one that came first
  /// would push the object away. A finger waits for one that lies in front of it.
  Eigen::VectorXd fingers(const Eigen::VectorXd& before, const Eigen::VectorXd& goal,
                          double together, Duration elapsed) const;

  /// The base on its way from `before` to `goal`.
  Pose base(const Pose& before, const Pose& goal, Duration elapsed) const;

 private:
  const model::HandModel& hand_;
  MotionLimitOptions options_;
  FingerCollisionLimiter collisions_;
};

}  // namespace prehend::mapping
