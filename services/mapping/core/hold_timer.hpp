#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace prehend::mapping {

struct HoldTimerOptions {
  /// The hand is told to stay once no posture has been answered for this time.
  Duration posture_timeout = std::chrono::milliseconds(60);
  /// Between two commands to stay there is at least this time.
  Duration period = std::chrono::milliseconds(10);
};

/// When to tell the robot hand to stay where it is.
class HoldTimer {
 public:
  explicit HoldTimer(const HoldTimerOptions& options) : options_(options) {}

  /// A posture has been answered.
  void answered(Time now) { last_answer_ = now; }
  /// Whether a command to stay is due; it then counts as given.
  bool due(Time now) {
    if (!last_answer_ || now - *last_answer_ < options_.posture_timeout) return false;
    // In lockstep several ticks may come at one time.
    if (last_hold_ && now - *last_hold_ < options_.period) return false;
    last_hold_ = now;
    return true;
  }

 private:
  HoldTimerOptions options_;
  std::optional<Time> last_answer_, last_hold_;
};

}  // namespace prehend::mapping
