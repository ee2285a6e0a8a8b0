#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "services/glove/core/frame_source.hpp"

namespace prehend::glove {

/// What a magnetic tracker adds to every sensor.
struct TrackerNoise {
  double sigma = 0.0015;        // m, of each coordinate of a position
  double extreme_rate = 0.01;   // share of readings that are extreme points
  double extreme_least = 0.05;  // m, that they are off, in any direction
  double extreme_most = 0.50;
  std::uint64_t seed = 1;
};

/// What the Processor makes of hands whose truth is known, when a tracker's noise is added to them.
/// All lengths are those of fingertips in H. A fingertip's speed is that of the truth over 1/15 s.
struct FilterStats {
  std::size_t frames = 0, slow = 0, fast = 0, extremes = 0;  // slow, fast: fingertips counted
  double noise_in = 0;   // m, RMS of a coordinate that the noise gives an unfiltered fingertip ...
  double noise_out = 0;  // ... and error of the published one, below slow_speed
  double lag = 0;       // s, the delay that explains the published fingertip best, above fast_speed
  double moved = 0;     // m, furthest that extreme points moved a published fingertip
  std::size_t far = 0;  // fingertips that they moved further than moved_aim
  double withheld = 0;  // share of the fingertips that extreme points kept from being published
};
inline constexpr double slow_speed = 0.05, fast_speed = 0.20;  // m/s
inline constexpr double moved_aim = 0.005;                     // m

/// Gathers them over any number of takes.
class FilterMeasurement {
 public:
  explicit FilterMeasurement(const TrackerNoise& noise) : noise_(noise) {}

  /// Clean frames with sensors on back of hand and fingers, in the order of time.
  void add(const std::vector<Frame>& truth);
  void add(const FilterMeasurement& other);
  FilterStats stats() const;

 private:
  static constexpr int delays = 81;  // 0 to 0.1 s
  TrackerNoise noise_;
  std::size_t frames_ = 0, slow_ = 0, fast_ = 0, extremes_ = 0, published_ = 0, withheld_ = 0,
              far_ = 0;
  double in_ = 0, out_ = 0, moved_ = 0;   // in, out: sums of squares
  std::array<double, delays> delayed_{};  // sums of squares against the truth that long ago
};

/// The frames of a source, all of them or, where `rate` (Hz) is given, as a slower tracker would
/// have measured them: positions between two frames on a straight line.
std::vector<Frame> frames_of(const FrameSource& source, double rate = 0);

}  // namespace prehend::glove
