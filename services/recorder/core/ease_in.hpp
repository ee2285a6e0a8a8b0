#pragma once

#include <Eigen/Core>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::recorder {

/// Where a robot hand is, or shall be.
struct HandPlace {
  Eigen::VectorXd dof;  // rad or m, as the hand's DoFs
  Pose X_WB = Pose::Identity();
};

/// A smooth way (cubic in time, at rest at both ends) that moves all DoFs and the base together, no
/// DoF faster than its limit allows and the base at 0.25 m/s and 0.8 rad/s at most.
class EaseIn {
 public:
  /// Sizes must be the hand's. `share`: of the velocity limits that is used, in (0, 1].
  EaseIn(const model::HandModel& hand, HandPlace from, HandPlace to, double share = 0.5);

  Duration duration() const { return duration_; }
  /// t from the start; before and behind the ends: the ends.
  HandPlace at(Duration t) const;

 private:
  HandPlace from_, to_;
  Duration duration_{};
};

}  // namespace prehend::recorder
