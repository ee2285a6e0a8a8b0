#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/time.hpp"

namespace prehend::glove {

/// Cut-offs of a One Euro filter (Casiez, Roussel, Vogel 2012): steady when slow, quick when fast.
struct OneEuroOptions {
  /// Hz, at rest. At 30 Hz it takes more than half of the noise away.
  double cutoff = 1.2;
  /// Hz that every m/s (or rad/s) adds to the cut-off: from 0.2 m/s on it lags less than a frame.
  double slope = 35;
  double speed_cutoff = 3;  // Hz, of the speed estimate
  double memory = 0.3;      // s, after which the filter starts anew
};

class PointFilter {
 public:
  explicit PointFilter(const OneEuroOptions& options) : options_(options) {}
  Eigen::Vector3d operator()(Time stamp, const Eigen::Vector3d& p);

 private:
  OneEuroOptions options_;
  std::optional<Time> last_;
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
};

class RotationFilter {
 public:
  explicit RotationFilter(const OneEuroOptions& options) : options_(options) {}
  Eigen::Quaterniond operator()(Time stamp, const Eigen::Quaterniond& q);

 private:
  OneEuroOptions options_;
  std::optional<Time> last_;
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  double speed_ = 0;  // rad/s
};

}  // namespace prehend::glove
