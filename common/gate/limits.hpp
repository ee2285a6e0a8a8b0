#pragma once

#include <Eigen/Core>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::gate {

/// How fast something may go, and how fast it may become faster: rad/s, rad/s², or m/s, m/s².
struct MotionLimit {
  double speed = 0, acceleration = 0;
};

/// What no command that leaves the gate passes. Defaults of the base stand above what mapping asks
/// for (1 m/s, 3 rad/s), so that the gate cuts nothing of a sound stream.
struct Limits {
  /// Range of each DoF, rad or m.
  Eigen::VectorXd lower, upper;
  /// Speed and acceleration of each DoF.
  std::vector<MotionLimit> joint;
  /// What each DoF may push with, N m or N.
  Eigen::VectorXd effort;
  /// Speed and acceleration of the base's place, m/s and m/s².
  MotionLimit base{1.2, 300};
  /// Those of its orientation, rad/s and rad/s².
  MotionLimit turn{3.6, 900};
  /// Where the base may be in W, m: from the lowest corner of the box to the highest.
  Eigen::Vector3d box_lower = Eigen::Vector3d::Constant(-10);
  Eigen::Vector3d box_upper = Eigen::Vector3d::Constant(10);
};

/// What the hand's own description says: [gate] of hand.toml, else its limits. Joints may go 1.2
/// times as fast as they can, since a stream that uses all of a joint's speed is a sound one, and
/// push with all that their drives have.
Limits limits_of(const model::HandModel& hand);

/// An error where a limit allows nothing.
Expected<void> check(const Limits& limits);

}  // namespace prehend::gate
