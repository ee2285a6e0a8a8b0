#include "services/performer/core/reproduction/way.hpp"

#include <algorithm>

#include "common/base/motion.hpp"

namespace prehend::performer {

namespace {

constexpr double short_way = 1e-4;  // m or rad: no movement
constexpr double min_time = 0.15;   // s, of one movement

}  // namespace

Way::Way(std::vector<Pose> poses, double speed, double turn_speed) : poses_(std::move(poses)) {
  double end = 0;
  ends_.push_back(end);
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    const double length = (poses_[i].translation() - poses_[i - 1].translation()).norm();
    const double angle = angle_between(poses_[i].linear(), poses_[i - 1].linear());
    if (length > short_way || angle > short_way)
      end += std::max({min_time, length / speed, angle / turn_speed});
    ends_.push_back(end);
  }
}

Way Way::then(const Way& next) const {
  Way made = next;
  made.planned_ = planned_;
  made.planned_time_ = planned_time_;
  return made;
}

Pose Way::at(double t) const {
  if (planned_ && (t < planned_time_ || poses_.empty())) return planned_(t);
  t -= planned_time_;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (t >= ends_[i]) continue;
    return interpolate(poses_[i - 1], poses_[i],
                       minimum_jerk((t - ends_[i - 1]) / (ends_[i] - ends_[i - 1])));
  }
  return poses_.back();
}

}  // namespace prehend::performer
