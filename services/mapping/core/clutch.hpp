#pragma once

#include <Eigen/Core>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::mapping {

struct ClutchOptions {
  /// Robot and human hand come together again at this speed, m/s.
  double speed = 0.1;
  /// Their orientations come together at this speed, rad/s.
  double turn_speed = 0.5;
  /// Their fingers come together at this speed, rad/s, or what radian_of() makes of it.
  double finger_speed = 0.5;
  /// Fingers that have changed in a longer time without a posture that was answered have swept.
  Duration max_pause = std::chrono::milliseconds(300);
  /// A hand that is this far from where it was when it was answered last has jumped, m, rad.
  double jump = 0.2, turned = 1.0;
};

/// What is between the human hand and the robot's after an interruption. The robot hand follows
/// every motion of the human one, and meanwhile goes slowly to where that is, so that it never
/// sweeps there. Before the first interruption nothing is between them. Pure: it is told how much
/// time has passed. Keeps a reference to the hand.
class Clutch {
 public:
  Clutch(const model::HandModel& hand, const ClutchOptions& options)
      : hand_(hand), options_(options) {}

  /// From now on a human hand whose grasp frame is at X_WG stands for one at X_WG_robot.
  void hold(const Pose& X_WG, const Pose& X_WG_robot);
  /// From now on an answer of `dof` stands for `dof_robot`.
  void hold(const Eigen::VectorXd& dof, const Eigen::VectorXd& dof_robot);
  /// They come together.
  void fade(Duration elapsed);

  /// What the human hand stands for.
  Pose X_WG(const Pose& X_WG) const;
  /// What the fingers' answer stands for, not limited.
  Eigen::VectorXd dof(const Eigen::VectorXd& dof) const;

  /// Has it jumped from one posture to the next?
  bool is_jump(const Pose& from, const Pose& to) const;
  const ClutchOptions& options() const { return options_; }

 private:
  const model::HandModel& hand_;
  ClutchOptions options_;
  bool is_held_ = false;            // otherwise nothing is between them, to the last bit
  Pose offset_ = Pose::Identity();  // in W: translation, and rotation about the hand
  Eigen::VectorXd dof_offset_;      // empty: none
};

}  // namespace prehend::mapping
