#include "services/mapping/core/trust.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace prehend::mapping {

namespace {

/// How much a number counts that is tolerated to deviate as much.
double share(double tolerance, double variance) {
  return std::min(1.0, tolerance * tolerance / std::max(variance, 1e-12));
}

}  // namespace

double reliability(const ObjectTrack& track, const TrustOptions& options) {
  const Eigen::Matrix4d& covariance = track.detection.covariance;
  const double position =
      covariance.topLeftCorner<3, 3>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  double least = share(options.sure_position, position);
  if (track.detection.shape.kind == model::ShapeKind::box)
    least = std::min(least, share(options.sure_turn, covariance(3, 3)));
  return std::min(least, share(options.sure_size * track.size, track.size_variance));
}

void Trust::step(const ObjectTrack* seen, Phase phase, Duration elapsed) {
  if (phase == Phase::direct) bound_.reset();
  if (seen != nullptr && phase != Phase::gripping)
    bound_.follow(reliability(*seen, options_), elapsed);
}

}  // namespace prehend::mapping
