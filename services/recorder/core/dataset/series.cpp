#include "services/recorder/core/dataset/series.hpp"

namespace prehend::recorder::dataset {

std::size_t newest(const std::vector<Time>& times, Time t) {
  const auto later = std::ranges::upper_bound(times, t);
  return later == times.begin() ? 0 : static_cast<std::size_t>(later - times.begin()) - 1;
}

Between between(const std::vector<Time>& times, Time t) {
  const std::size_t before = newest(times, t);
  if (before + 1 == times.size() || t <= times[before]) return {before, before, 0};
  const Duration gap = times[before + 1] - times[before];
  if (gap > max_bridge) return {before, before, 0};
  return {before, before + 1, to_seconds(t - times[before]) / to_seconds(gap)};
}

Eigen::VectorXd at(const Numbers& series, Time t) {
  const auto [before, after, share] = between(series.times, t);
  return (1 - share) * series.values[before] + share * series.values[after];
}

Pose at(const Poses& series, Time t) {
  const auto [before, after, share] = between(series.times, t);
  return interpolate(series.values[before], series.values[after], share);
}

}  // namespace prehend::recorder::dataset
