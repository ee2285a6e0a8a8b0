#include "services/glove/core/calibration/still.hpp"

#include <algorithm>

namespace prehend::glove {
namespace {

/// Furthest of a point from where it is in another sample, m.
double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  double most = 0;
  for (Eigen::Index i = 0; i + 3 <= a.size(); i += 3)
    most = std::max(most, (a - b).segment<3>(i).norm());
  return most;
}

}  // namespace

std::optional<Held> StillTaker::see(Time stamp, const Eigen::VectorXd& points) {
  // Time that goes back belongs to another clock; other points to another glove.
  if (!window_.empty() &&
      (stamp <= window_.back().first || points.size() != window_.back().second.size()))
    window_.clear();
  window_.emplace_back(stamp, points);
  while (stamp - window_.front().first > options_.still_for) window_.pop_front();
  Held held{Eigen::VectorXd::Zero(points.size()), 0};
  for (const auto& [time, sample] : window_)
    held.mean += sample / static_cast<double>(window_.size());
  for (const auto& [time, sample] : window_)
    held.wobble = std::max(held.wobble, distance(sample, held.mean));
  const auto wait = [&](std::string_view why) {
    waiting_for_ = why;
    return std::nullopt;
  };
  if (held.wobble > options_.still_within) return wait("keep still");
  // A frame's time may be missing at the window's begin.
  if (stamp - window_.front().first < options_.still_for * 9 / 10 ||
      static_cast<int>(window_.size()) < options_.min_samples)
    return wait("keep still a moment longer");
  if (last_ && last_->size() == held.mean.size() && distance(held.mean, *last_) < options_.apart)
    return wait("move on to the next one");
  last_ = held.mean;
  window_.clear();
  return held;
}

}  // namespace prehend::glove
