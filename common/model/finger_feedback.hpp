#pragma once

#include <array>

#include "common/model/human_hand.hpp"

namespace prehend::model {

/// What a finger of the wearer is to feel of the robot finger that it leads.
struct FingerFeedback {
  double force = 0;  // N, that presses on the robot's finger
  bool contact = false, slip = false;
  bool limit = false;  // the robot's finger can close no further
};
using HandFeedback = std::array<FingerFeedback, finger_count>;  // thumb first

}  // namespace prehend::model
