#pragma once

#include "common/base/time.hpp"
#include "common/model/finger_feedback.hpp"

namespace prehend::glove {

/// What the wearer is to feel.
struct Feedback {
  Time stamp{};  // of the touch
  model::HandFeedback fingers{};
};

/// For which what was told holds. After it a glove lets go, since most actuators keep what they
/// were told last.
inline constexpr Duration feedback_holds = std::chrono::milliseconds(100);

}  // namespace prehend::glove
