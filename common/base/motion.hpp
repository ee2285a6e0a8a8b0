#pragma once

#include <algorithm>

#include "common/base/pose.hpp"

namespace prehend {

/// Share of the way after a share of the time, of a movement from rest to rest with the least jerk
/// [Flash1985]; outside 0 to 1 it stands.
inline double minimum_jerk(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  return t * t * t * (10 - 15 * t + 6 * t * t);
}

/// A pose in W after a movement in W, m.
inline Pose moved(Pose X_W, const Eigen::Vector3d& by_W) {
  X_W.pretranslate(by_W);
  return X_W;
}

}  // namespace prehend
