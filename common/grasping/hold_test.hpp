#pragma once

#include <optional>
#include <string>

#include "common/grasping/world.hpp"

namespace prehend::grasping {

/// What is done with the object after it was lifted and held still.
struct HoldOptions {
  double lift = 0.10;                // m, by which the hand is lifted
  double lift_speed = 0.1;           // m/s, at which it is lifted
  double hold = 3.0;                 // s, that the object is held up there
  double max_slip = 0.020;           // m, relative to each palm
  double max_turn = 0.261799387799;  // rad (15°)
  /// The long form: shaken along ±x, ±y, ±z of B of the first hand, then turned upside down and
  /// held there.
  bool shake = false;
  double shake_acceleration = 0.5 * 9.81;  // m/s², at most the arm's
  double shake_stroke = 0.02;              // m: there and back, once in each direction
  bool turn_over = false;    // by half a turn about the horizontal axis nearest x of B
  double turn_rate = 1.0;    // rad/s, at which it is turned over
  double turned_hold = 1.0;  // s, that the object is held upside down

  static HoldOptions long_form() { return {.shake = true, .turn_over = true}; }
};

struct HoldResult {
  bool held = false;   // survived all that was asked
  double slip = 0;     // m, largest displacement relative to a palm from the start of the test
  double turn = 0;     // rad, the same
  double drift = 0;    // m/s, relative to the first palm, in the last half second of the last hold
  std::string reason;  // why it was not held; empty when it was
  /// Each phase: survived or not; none when it was not asked for or not reached.
  std::optional<bool> lift, shake, turned_over;
};

/// Lifts all hands of the world together as they are driven now, holds, and looks where the object
/// is; then the long form, if it is asked for. Uses up the world: give it a clone(). Ends early
/// once the answer is no.
HoldResult hold_test(World& world, int object, const HoldOptions& options = {});

}  // namespace prehend::grasping
