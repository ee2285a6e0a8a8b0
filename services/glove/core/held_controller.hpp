#pragma once

#include "services/glove/core/bare_hand.hpp"

namespace prehend::glove {

/// A controller of a headset in a hand, as OpenXR tells it. G: its grip pose: origin in the middle
/// of the palm, -z out of the hand at the thumb's side, x out of the back of a right hand and out
/// of the palm of a left one.
struct HeldController {
  bool left = false;
  Pose X_RG = Pose::Identity();  // in any frame R
  double trigger = 0, grip = 0;  // how far they are pressed, 0 to 1
};

/// Where a hand of average size would be that holds it: the trigger bends the index finger, the
/// grip those behind it, and what is pressed more the thumb.
Landmarks hand_on(const HeldController& controller);

}  // namespace prehend::glove
