#pragma once

#include "common/base/time.hpp"
#include "services/mapping/core/arbitration.hpp"
#include "services/mapping/core/object_tracks.hpp"
#include "services/mapping/core/ramp.hpp"

namespace prehend::mapping {

/// A detection that deviates by no more than this is as good as exact, because a grasp forgives as
/// much. Beyond, it counts (tolerance / standard deviation)².
struct TrustOptions {
  /// The largest standard deviation of the position, in any direction, that is as good as none, m.
  double sure_position = 0.01;
  /// The largest standard deviation of the turn of a box that is as good as none, rad (10°); other
  /// shapes are round about the axis that they stand on.
  double sure_turn = 0.1745;
  /// The largest standard deviation of the size over recent detections that is as good as none, as
  /// a share of the mean size.
  double sure_size = 0.2;
};

/// How far what is known of this object can be relied on, 0 to 1: the least of position, turn and
/// size.
double reliability(const ObjectTrack& track, const TrustOptions& options);

/// How much the intelligent answer may count at most, by how reliable the object is that it is for.
/// Arbitration says whether it counts at all; the smaller of both is its weight. Follows what is
/// seen no faster than Arbitration's weight moves, so that the weight never jumps.
class Trust {
 public:
  /// ramp: time in which it goes from 0 to 1 or back.
  Trust(const TrustOptions& options, Duration ramp) : options_(options), bound_(ramp) {}

  /// seen: the object that is reached for, nullptr when it is not seen now. What is gripped or lost
  /// keeps the trust that it had; without an object there is none.
  void step(const ObjectTrack* seen, Phase phase, Duration elapsed);

  double bound() const { return bound_.value(); }

 private:
  TrustOptions options_;
  Ramp bound_;
};

}  // namespace prehend::mapping
