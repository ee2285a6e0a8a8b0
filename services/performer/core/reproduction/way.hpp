#pragma once

#include <functional>
#include <vector>

#include "common/base/pose.hpp"

namespace prehend::performer {

/// A movement from pose to pose, at rest at each, with the least jerk between two [Flash1985]; or
/// as somebody else has planned it.
class Way {
 public:
  Way() = default;
  /// speed: m/s, turn_speed: rad/s, on average between two poses.
  Way(std::vector<Pose> poses, double speed, double turn_speed);

  /// From rest to rest, as planned; duration: s.
  Way(std::function<Pose(double t)> planned, double duration)
      : planned_(std::move(planned)), planned_time_(duration) {}

  /// On from its end: from there on as `next` goes.
  Way then(const Way& next) const;

  Pose at(double t) const;  // s
  double duration() const { return planned_time_ + (ends_.empty() ? 0 : ends_.back()); }

 private:
  std::function<Pose(double)> planned_;  // that is gone first, if any
  double planned_time_ = 0;              // s
  std::vector<Pose> poses_;
  std::vector<double> ends_;  // s, when each pose is reached
};

}  // namespace prehend::performer
