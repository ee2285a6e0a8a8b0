#pragma once

#include <optional>

#include "common/model/human_hand.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

struct HandInFrame {
  Pose X_TH;
  model::HumanPosture posture;
};

/// The hand that emulated devices see: the frame's joint angles or, where it has none, those that
/// reach its fingertips, near `before`. Nothing without a back of the hand.
std::optional<HandInFrame> hand_in(const Frame& frame, const model::HumanHand& hand,
                                   const model::HumanPosture& before);

}  // namespace prehend::glove
