#pragma once

#include <cstdint>
#include <vector>

#include "common/base/time.hpp"
#include "services/recognition/core/detection/detector.hpp"

namespace prehend::recognition {

struct TrackerOptions {
  double gate = 0.10;        // m; further away it is another object of the same name
  double still = 0.006;      // m and
  double still_turn = 0.14;  // rad: less than that between pictures is noise of a steady object
  double max_weight = 12;    // pictures that a steady pose is averaged over
  Duration patience = std::chrono::milliseconds(500);  // unseen for longer: gone
};

/// An object followed through the pictures.
struct Track {
  std::uint32_t id = 0;
  Sighting seen;  // the last one; `at` is averaged while the object stands still
  bool moving = false;
  Time last_seen;
  double weight = 0;  // pictures in the average
  TablePose anchor;   // last place measured
};

/// Ties the sightings of successive pictures together: an object keeps its number, a steady object
/// a steady pose.
class Tracker {
 public:
  explicit Tracker(const TrackerOptions& options = {}) : options_(options) {}

  /// Takes the sightings of a picture exposed at `stamp` (of those with a place). Returns the
  /// tracks that it shows.
  std::vector<Track> update(Time stamp, const std::vector<Sighting>& sightings);
  /// Numbers of the tracks that have not been seen for too long at `now`; they are forgotten.
  std::vector<std::uint32_t> expire(Time now);

  const std::vector<Track>& tracks() const { return tracks_; }

 private:
  TrackerOptions options_;
  std::vector<Track> tracks_;
  std::uint32_t next_id_ = 1;
};

}  // namespace prehend::recognition
