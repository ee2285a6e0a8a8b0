#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/finger_feedback.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::mapping {

/// What a link of the robot hand feels.
struct LinkTouch {
  bool touching = false;
  double pressure = 0;  // N, into the link; below 0: not measured
  bool slipping = false;
};

/// A human finger feels the links of the robot's whose tip it leads; one that leads none feels
/// nothing, nor does anybody feel the palm. touch: of each link of the hand; dof: rad, or m of what
/// slides. Fails on other sizes and on what is not finite.
Expected<model::HandFeedback> feel(const model::HandModel& hand,
                                   const std::vector<LinkTouch>& touch, const Eigen::VectorXd& dof);

}  // namespace prehend::mapping
