#include "gate.hpp"

#include <algorithm>

namespace prehend::glove {

PointGate::Verdict PointGate::check(Time stamp, const Eigen::Vector3d& p) {
  const auto age = [&](Time earlier) { return to_seconds(stamp - earlier); };
  if (track_ && age(track_->stamp) > options_.memory) track_.reset();
  if (candidate_ && age(candidate_->stamp) > options_.memory) candidate_.reset();

  if (track_) {
    const double dt = age(track_->stamp);
    const double reach = options_.noise + options_.acceleration * dt * dt;
    if ((p - (track_->p + dt * track_->velocity)).norm() <= reach) {
      accept(stamp, p);
      return Verdict::good;
    }
  }
  const bool confirmed =
      candidate_ &&
      (p - candidate_->p).norm() <= options_.noise + options_.agreement * age(candidate_->stamp);
  if (confirmed) {
    track_ = Track{candidate_->stamp, candidate_->p, Eigen::Vector3d::Zero()};
    accept(stamp, p);
    return Verdict::good;
  }
  candidate_ = Candidate{stamp, p};
  return track_ ? Verdict::extreme : Verdict::unconfirmed;
}

void PointGate::accept(Time stamp, const Eigen::Vector3d& p) {
  if (!track_) {
    track_ = Track{stamp, p, Eigen::Vector3d::Zero()};
  } else {
    // Smoothed over about 50 ms, so that noise at high rates does not pass for velocity.
    const double dt = to_seconds(stamp - track_->stamp);
    const double share = std::min(1.0, dt / 0.05);
    track_->velocity += share * ((p - track_->p) / dt - track_->velocity);
    track_->p = p;
    track_->stamp = stamp;
  }
  candidate_.reset();
}

}  // namespace prehend::glove
