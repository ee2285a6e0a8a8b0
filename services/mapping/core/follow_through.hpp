#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/past_contact.hpp"

namespace prehend::mapping {

struct FollowThroughOptions {
  /// The finger that has come farthest goes on at this speed, rad/s.
  double speed = 0.6;
  /// The operator lets go by opening the closing DoFs by this angle in the mean, rad.
  double opened = 0.1;
};

/// A known object may be smaller than it was seen, or the first finger may have pushed it aside, so
/// that fingers stop where they learnt to and press on nothing. Once the operator has closed on it,
/// they go on in proportion to their way, until they are stopped (the squeeze then takes over) or
/// the operator opens. Keeps a reference to the hand.
class FollowThrough {
 public:
  explicit FollowThrough(const model::HandModel& hand, const FollowThroughOptions& options = {});

  /// The posture to go to instead of this one, both DoF values in rad or m, within the limits.
  /// closed: it reaches into the object; touching: something stops the robot's fingers; most: the
  /// finger that has come farthest goes on by at most this angle, rad.
  Eigen::VectorXd go_on(const Eigen::VectorXd& dof, bool closed, bool touching, Duration elapsed,
                        double most = model::full_follow_through);
  /// Forgets the grasp.
  void reset();

 private:
  /// How far each DoF has closed from the open hand, rad or what stands for it; 0 for what does not
  /// close.
  Eigen::ArrayXd way(const Eigen::VectorXd& dof) const;

  const model::HandModel& hand_;
  FollowThroughOptions options_;
  Eigen::VectorXd open_;
  int closing_ = 0;             // DoFs that close
  double further_ = 0;          // rad
  std::optional<double> peak_;  // mean way while closed
};

}  // namespace prehend::mapping
