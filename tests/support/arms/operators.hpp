#pragma once

#include <utility>

#include "common/arm/controller.hpp"
#include "common/base/random.hpp"

namespace prehend::test {

/// A person, well behaved or not, who leads an arm's hand: moves smoothly, stops, jumps, trembles,
/// reaches far out, through the table or through the arm's base, turns the hand over, is not
/// finite for a frame. The same for the same seed.
class Operator {
 public:
  Operator(const model::ArmModel& arm, std::uint64_t seed);

  /// The wish of the next frame, and how long after the last it comes, s.
  std::pair<arm::Wish, double> next();

 private:
  void choose_goal();

  const model::ArmModel& arm_;
  Random random_;
  Pose X_WB_, goal_;
  double speed_ = 0, turning_ = 0, tremor_ = 0;
  int left_ = 0;  // frames until the next goal
};

}  // namespace prehend::test
