#include "services/recognition/core/detection/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::recognition {
namespace {

/// Difference of two turns of a box, which looks the same after half a turn (a cube after a
/// quarter).
double turn_between(const model::Shape& shape, double a, double b) {
  if (shape.kind != model::ShapeKind::box) return 0;
  const bool square = std::abs(shape.size.x() - shape.size.y()) < 1e-3;
  return std::remainder(a - b, square ? std::numbers::pi / 2 : std::numbers::pi);
}

}  // namespace

std::vector<Track> Tracker::update(Time stamp, const std::vector<Sighting>& sightings) {
  std::vector<Track> shown;
  std::vector<char> used(tracks_.size(), 0);
  for (const Sighting& sighting : sightings) {
    if (!sighting.at) continue;
    const TablePose& at = *sighting.at;
    double least = options_.gate;
    std::size_t nearest = tracks_.size();
    for (std::size_t i = 0; i < used.size(); ++i) {
      const Track& track = tracks_[i];
      if (used[i] || track.seen.name != sighting.name) continue;
      const double distance = std::hypot(track.anchor.x - at.x, track.anchor.y - at.y);
      if (distance >= least) continue;
      least = distance;
      nearest = i;
    }
    if (nearest == tracks_.size()) {
      tracks_.push_back({next_id_++, sighting, false, stamp, 1, at});
      shown.push_back(tracks_.back());
      continue;
    }
    used[nearest] = 1;
    Track& track = tracks_[nearest];
    track.last_seen = std::max(track.last_seen, stamp);
    if (!sighting.fresh) {  // nothing moved there: no news
      track.moving = false;
      shown.push_back(track);
      continue;
    }
    const TablePose before = *track.seen.at;
    const double turn = turn_between(sighting.shape, at.yaw, before.yaw);
    const double step = std::hypot(at.x - before.x, at.y - before.y);
    const bool steady = step < options_.still && std::abs(turn) < options_.still_turn;
    track.moving = !steady;
    track.weight = steady ? std::min(track.weight + 1, options_.max_weight) : 1;
    const double share = 1 / track.weight;
    track.anchor = at;
    track.seen = sighting;
    // The turn keeps its branch: a box that looks the same from behind does not flip.
    track.seen.at = TablePose{before.x + share * (at.x - before.x),
                              before.y + share * (at.y - before.y), before.yaw + share * turn};
    shown.push_back(track);
  }
  return shown;
}

std::vector<std::uint32_t> Tracker::expire(Time now) {
  std::vector<std::uint32_t> gone;
  std::erase_if(tracks_, [&](const Track& track) {
    if (now - track.last_seen <= options_.patience) return false;
    gone.push_back(track.id);
    return true;
  });
  return gone;
}

}  // namespace prehend::recognition
