#pragma once

#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "common/ros2/joints.hpp"

namespace prehend::ros {

/// What a hand shall do while nodes lead it by trajectories. They are taken as a
/// joint_trajectory_controller takes them: each names exactly the joints that lead the hand's DoFs,
/// replaces the one before, and goes on straight lines from where the hand is told to be at that
/// moment; the last point is held. Pure. Keeps a reference to the hand.
class TrajectoryFollower {
 public:
  explicit TrajectoryFollower(const model::HandModel& hand) : hand_(hand) {}

  /// trajectory: as parse_joint_trajectory() returns it; one without points ends what is followed.
  /// here: values of the DoFs, where the hand is if nothing is followed. One that is refused
  /// changes nothing: other joints, a point outside a joint's range, over already, or a stamp that
  /// is more than 10 s away from now.
  Expected<void> take(const ros2::JointTrajectory& trajectory, const Eigen::VectorXd& here,
                      Time now);
  /// Stays at these values of the DoFs, unless something is followed.
  void hold(const Eigen::VectorXd& here, Time now) {
    if (knots_.empty()) knots_ = {{now, hand_.clamp(here)}};
  }
  /// Nothing is followed any more.
  void stop() { knots_.clear(); }

  /// Values of the DoFs. Nothing: nothing is followed.
  std::optional<Eigen::VectorXd> goal(Time now) const;

 private:
  struct Knot {
    Time at;
    Eigen::VectorXd dof;
  };
  using Order = std::vector<Eigen::Index>;  // of each DoF: its place in the trajectory

  Expected<Order> order_of(const std::vector<std::string>& names) const;
  Expected<Eigen::VectorXd> dof_of(const std::vector<double>& positions, const Order& order) const;

  const model::HandModel& hand_;
  std::vector<Knot> knots_;  // later and later; the first is where it began
};

}  // namespace prehend::ros
