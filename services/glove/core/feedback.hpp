#pragma once

#include <array>

#include "common/base/time.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::glove {

/// What a finger of the wearer is to feel.
struct FingerFeedback {
  double force = 0;  // N, that presses on the robot's finger
  bool contact = false, slip = false;
  bool limit = false;  // the robot's finger can close no further
};

/// What the robot hand feels, thumb first.
struct Feedback {
  Time stamp{};  // of the touch
  std::array<FingerFeedback, model::finger_count> fingers{};
};

/// For which what was told holds. After it a glove lets go, since most actuators keep what they
/// were told last.
inline constexpr Duration feedback_holds = std::chrono::milliseconds(100);

}  // namespace prehend::glove
