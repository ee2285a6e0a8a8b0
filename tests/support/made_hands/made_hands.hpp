#pragma once

#include <string>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::test {

/// A hand that nobody has built, of boxes: fingers along z that bend towards what is between them.
struct MadeHand {
  enum class Motors { of_joints, of_fingers, one };

  int fingers = 3;  // 2 to 5
  int joints = 2;   // of each; the first of four or more moves the finger aside and does not close
  Motors motors = Motors::of_joints;
  bool thumb = true;       // one against a row of the others; else all around a circle
  bool left = false;       // mirrored
  bool backwards = false;  // the thumb is the last of the fingertips, not the first

  std::string name() const;
};

/// Its fingertips are called thumb, 1, 2, ... from where the thumb is, or around the circle.
model::HandModel made_hand(const MadeHand& hand);

/// Of two to five fingers with one to five joints each and all kinds of motors, right and left:
/// from one DoF to 25.
std::vector<MadeHand> made_hands();

}  // namespace prehend::test
