#include "services/glove/core/gate.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::glove {
namespace {

constexpr double fastest = 4;    // m/s, of any point on a hand
constexpr double calming = 0.1;  // s, after which a third of an acceleration is still expected

}  // namespace

PointGate::Verdict PointGate::check(Time stamp, const Eigen::Vector3d& p) {
  const auto age = [&](Time earlier) { return to_seconds(stamp - earlier); };
  if (track_ && age(track_->stamp) > options_.memory) track_.reset();
  if (candidate_ && age(candidate_->stamp) > options_.memory) candidate_.reset();
  if (before_ && age(before_->stamp) > options_.memory) before_.reset();

  if (track_) {
    const double dt = age(track_->stamp), square = dt * dt;
    const double active =
        std::min(options_.acceleration, options_.onset + 2 * track_->acceleration);
    const double reach = std::max(options_.noise + options_.onset * square,
                                  std::min(options_.noise + active * square, options_.farthest));
    if ((p - (track_->p + dt * track_->velocity)).norm() <= reach) {
      accept(stamp, p);
      return Verdict::good;
    }
  }
  if (confirmed(stamp, p)) {
    // Its velocity is not known yet.
    track_ =
        Track{candidate_->stamp, candidate_->p, Eigen::Vector3d::Zero(), options_.acceleration};
    accept(stamp, p);
    return Verdict::good;
  }
  before_ = candidate_;
  candidate_ = Candidate{stamp, p};
  return track_ ? Verdict::extreme : Verdict::unconfirmed;
}

bool PointGate::confirmed(Time stamp, const Eigen::Vector3d& p) const {
  if (!candidate_) return false;
  const double dt = to_seconds(stamp - candidate_->stamp);
  const Eigen::Vector3d step = p - candidate_->p;
  const double near = options_.noise + options_.agreement * dt;
  if (step.norm() <= (track_ ? std::min(near, options_.farthest) : near)) return true;
  if (!before_) return false;
  const double earlier = to_seconds(candidate_->stamp - before_->stamp);
  const Eigen::Vector3d bend = step - dt / earlier * (candidate_->p - before_->p);
  return bend.norm() <= 2 * options_.noise && step.norm() <= fastest * dt;
}

void PointGate::accept(Time stamp, const Eigen::Vector3d& p) {
  if (!track_) {
    track_ = Track{stamp, p, Eigen::Vector3d::Zero()};
  } else {
    const double dt = to_seconds(stamp - track_->stamp);
    const double surprise = (p - (track_->p + dt * track_->velocity)).norm() - options_.noise;
    track_->acceleration =
        std::max(track_->acceleration * std::exp(-dt / calming), surprise / (dt * dt));
    // Smoothed over about 50 ms, so that noise at high rates does not pass for velocity.
    const double share = std::min(1.0, dt / 0.05);
    track_->velocity += share * ((p - track_->p) / dt - track_->velocity);
    track_->p = p;
    track_->stamp = stamp;
  }
  candidate_.reset();
  before_.reset();
}

}  // namespace prehend::glove
