#include "services/mapping/core/object_tracks.hpp"

namespace prehend::mapping {

namespace {

Expected<void> check(const Detection& detection, double min_probability) {
  if (!is_valid(detection.shape)) return fail("detection without a shape");
  if (!is_finite(detection.X_WO)) return fail("detection not finite");
  // Written so that not-a-number fails.
  if (!(detection.probability >= min_probability)) return fail("detection not confident");
  if (!detection.covariance.allFinite() || (detection.covariance.diagonal().array() < 0).any())
    return fail("detection without a usable covariance");
  return {};
}

}  // namespace

Expected<void> ObjectTracks::observe(const Detection& detection) {
  if (auto usable = check(detection, options_.min_probability); !usable) return usable;
  const double size = characteristic_size(detection.shape);
  const auto [known, is_new] = tracks_.try_emplace(detection.track, ObjectTrack{detection, size});
  if (is_new) return {};
  ObjectTrack& track = known->second;
  // Late ones must not bring back an older place.
  if (track.detection.stamp > detection.stamp) return fail("detection out of order");
  track.detection = detection;
  constexpr double newest = 0.2;  // share of the newest size in mean and variance
  const double off = size - track.size;
  track.size += newest * off;
  track.size_variance = (1 - newest) * (track.size_variance + newest * off * off);
  return {};
}

void ObjectTracks::forget_old(Time now) {
  std::erase_if(tracks_, [&](const auto& entry) {
    return std::chrono::abs(now - entry.second.detection.stamp) > options_.max_age;
  });
}

}  // namespace prehend::mapping
