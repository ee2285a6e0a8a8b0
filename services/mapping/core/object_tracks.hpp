#pragma once

#include <cstdint>
#include <map>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/model/detection.hpp"

namespace prehend::mapping {

using model::Detection;

struct ObjectTrackOptions {
  /// A detection that is less probable than this, from 0 to 1, is refused.
  double min_probability = 0.6;
  /// An object whose last detection is older than this time is no longer known.
  Duration max_age = std::chrono::milliseconds(500);
};

/// An object with how much its size has varied from picture to picture.
struct ObjectTrack {
  Detection detection;                 // the newest one
  double size = 0, size_variance = 0;  // m, m²: characteristic_size, recent ones count more
};

/// The objects that are known, each by the number of its track: its newest detection, and mean and
/// variance of its size over recent ones.
class ObjectTracks {
 public:
  explicit ObjectTracks(const ObjectTrackOptions& options) : options_(options) {}

  /// Refuses what is not finite, has no valid shape, is not probable enough, or is older than what
  /// is known of this object.
  Expected<void> observe(const Detection& detection);
  void remove(std::uint32_t track) { tracks_.erase(track); }
  /// Forgets what has not been seen for max_age, or is as far in the future.
  void forget_old(Time now);

  const std::map<std::uint32_t, ObjectTrack>& known() const { return tracks_; }

 private:
  ObjectTrackOptions options_;
  std::map<std::uint32_t, ObjectTrack> tracks_;
};

}  // namespace prehend::mapping
