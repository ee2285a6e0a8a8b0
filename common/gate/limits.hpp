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
  Eigen::VectorXd lower, upper;                                // of the DoFs, rad or m
  std::vector<MotionLimit> joint;                              // of the DoFs
  Eigen::VectorXd effort;                                      // of the DoFs, N m or N
  MotionLimit base{1.2, 300};                                  // of the base's place
  MotionLimit turn{3.6, 900};                                  // of its orientation
  Eigen::Vector3d box_lower = Eigen::Vector3d::Constant(-10);  // m, of the base in W
  Eigen::Vector3d box_upper = Eigen::Vector3d::Constant(10);
};

/// What the hand's own description says: [gate] of hand.toml, else its limits. Joints may go 1.2
/// times as fast as they can, since a stream that uses all of a joint's speed is a sound one, and
/// push with all that their drives have.
Limits limits_of(const model::HandModel& hand);

/// An error where a limit allows nothing.
Expected<void> check(const Limits& limits);

}  // namespace prehend::gate
