#pragma once

#include <vector>

#include "common/base/pose.hpp"

namespace prehend::demonstration {

/// A movement from pose to pose, at rest at each, with the least jerk between two [Flash1985].
class Way {
 public:
  Way() = default;
  /// speed: m/s, turn_speed: rad/s, on average between two poses.
  Way(std::vector<Pose> poses, double speed, double turn_speed);

  Pose at(double t) const;  // s
  double duration() const { return ends_.empty() ? 0 : ends_.back(); }

 private:
  std::vector<Pose> poses_;
  std::vector<double> ends_;  // s, when each pose is reached
};

}  // namespace prehend::demonstration
