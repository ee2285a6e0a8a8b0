#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string_view>

#include "common/base/time.hpp"

namespace prehend::glove {

/// Lengths are in the unit of the points.
struct StillOptions {
  Duration still_for = std::chrono::milliseconds(500);  // that the hand must keep still
  double still_within = 0.004;                          // of every point from its mean meanwhile
  double apart = 0.015;  // that some point must have moved since the last taken
  int min_samples = 8;   // in that time
};

/// Points of a hand that kept still.
struct Held {
  Eigen::VectorXd mean;  // three coordinates a point
  double wobble = 0;     // furthest of a point from its mean
};

/// Waits until a hand keeps still somewhere else than before. Pure: time comes with the samples.
class StillTaker {
 public:
  explicit StillTaker(const StillOptions& options) : options_(options) {}

  /// A sample: three coordinates a point, the same points each time. Returns what was held once.
  std::optional<Held> see(Time stamp, const Eigen::VectorXd& points);
  /// Why the last sample did not complete anything, in few words.
  std::string_view waiting_for() const { return waiting_for_; }

 private:
  StillOptions options_;
  std::deque<std::pair<Time, Eigen::VectorXd>> window_;
  std::optional<Eigen::VectorXd> last_;
  std::string_view waiting_for_ = "the hand is not seen";
};

}  // namespace prehend::glove
