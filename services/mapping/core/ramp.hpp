#pragma once

#include <algorithm>

#include "common/base/time.hpp"

namespace prehend::mapping {

/// A share from 0 to 1 that follows what it shall be no faster than at a constant rate, so that
/// nothing that is blended by it jumps. Knows no clock: it is told how much time has passed.
class Ramp {
 public:
  /// whole: time in which it goes from 0 to 1 or back.
  explicit Ramp(Duration whole) : whole_(whole) {}

  /// goal: 0 to 1. elapsed: since the last step, 0 or more.
  void follow(double goal, Duration elapsed) {
    const double change = to_seconds(elapsed) / to_seconds(whole_);
    value_ += std::clamp(goal - value_, -change, change);
  }
  void reset() { value_ = 0; }
  double value() const { return value_; }

 private:
  Duration whole_;
  double value_ = 0;
};

}  // namespace prehend::mapping
