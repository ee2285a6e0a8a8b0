#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::mapping {

/// What a link of the robot hand feels.
struct LinkTouch {
  bool touching = false;
  double pressure = 0;  // N, into the link; below 0: not measured
  bool slipping = false;
};

/// What a human finger is to feel of the robot finger that it leads.
struct FingerFeedback {
  double force = 0;  // N, that presses on all its links
  bool contact = false, slip = false;
  bool limit = false;  // it can close no further
};
using HandFeedback = std::array<FingerFeedback, model::finger_count>;  // thumb first

/// A human finger feels the links of the robot's whose tip it leads; one that leads none feels
/// nothing, nor does anybody feel the palm. touch: of each link of the hand; dof: rad, or m of what
/// slides. Fails on other sizes and on what is not finite.
Expected<HandFeedback> feel(const model::HandModel& hand, const std::vector<LinkTouch>& touch,
                            const Eigen::VectorXd& dof);

}  // namespace prehend::mapping
