#pragma once

#include <string>

#include "world.hpp"

namespace prehend::grasping {

struct HoldOptions {
  double lift = 0.10;                 // m
  double lift_speed = 0.1;            // m/s
  double hold = 3.0;                  // s
  double most_slip = 0.020;           // m, relative to the palm
  double most_turn = 0.261799387799;  // rad (15°)
};

struct HoldResult {
  bool held = false;
  double slip = 0;     // m, largest displacement relative to the palm from the start of the test
  double turn = 0;     // rad, the same
  std::string reason;  // why it was not held; empty when it was
};

/// Lifts the hand as it is driven now, holds, and looks where the object is. Uses up the world:
/// give it a clone(). Ends early once the answer is no.
HoldResult hold_test(World& world, int object, const HoldOptions& options = {});

}  // namespace prehend::grasping
