#include "services/glove/core/one_euro.hpp"

#include <numbers>

namespace prehend::glove {
namespace {

/// Share of the new value in a first-order low pass.
double share(double cutoff, double dt) {
  const double tau = 1 / (2 * std::numbers::pi * cutoff);
  return dt / (dt + tau);
}

}  // namespace

Eigen::Vector3d PointFilter::operator()(Time stamp, const Eigen::Vector3d& p) {
  const double dt = last_ ? to_seconds(stamp - *last_) : -1;
  last_ = stamp;
  if (dt <= 0 || dt > options_.memory) {
    velocity_.setZero();
    return p_ = p;
  }
  velocity_ += share(options_.speed_cutoff, dt) * ((p - p_) / dt - velocity_);
  p_ += share(options_.cutoff + options_.slope * velocity_.norm(), dt) * (p - p_);
  return p_;
}

Eigen::Quaterniond RotationFilter::operator()(Time stamp, const Eigen::Quaterniond& q) {
  const double dt = last_ ? to_seconds(stamp - *last_) : -1;
  last_ = stamp;
  if (dt <= 0 || dt > options_.memory) {
    speed_ = 0;
    return q_ = q.normalized();
  }
  speed_ += share(options_.speed_cutoff, dt) * (q_.angularDistance(q) / dt - speed_);
  q_ = q_.slerp(share(options_.cutoff + options_.slope * speed_, dt), q).normalized();
  return q_;
}

}  // namespace prehend::glove
