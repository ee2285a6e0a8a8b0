#include "services/mapping/core/motion_limits.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::mapping {

Duration MotionLimits::step(Duration since) const {
  return std::clamp(since, Duration::zero(), options_.max_step);
}

Eigen::VectorXd MotionLimits::fingers(const Eigen::VectorXd& before, const Eigen::VectorXd& goal,
                                      double together, Duration elapsed) const {
  const double t = to_seconds(elapsed);
  const Eigen::VectorXd change = goal - before;
  const auto closes = [&](Eigen::Index i) {
    return hand_.dofs()[static_cast<std::size_t>(i)].closing * change[i] > 0;
  };
  const auto speed = [&](Eigen::Index i) {
    const model::HandDof& limits = hand_.dofs()[static_cast<std::size_t>(i)];
    const double most = limits.max_velocity;
    if (!closes(i)) return most;
    return most + together * (std::min(most, options_.closing_speed * radian_of(limits)) - most);
  };
  // Of the way that closes, what the finger that takes longest can go.
  double slowest = 1;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    if (closes(i)) slowest = std::min(slowest, speed(i) * t / std::abs(change[i]));
  Eigen::VectorXd next = before;
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    const double most = speed(i) * t;
    const double alone = std::clamp(change[i], -most, most);
    next[i] += closes(i) ? alone + together * (slowest * change[i] - alone) : alone;
  }
  return collisions_.go(before, next);
}

Pose MotionLimits::base(const Pose& before, const Pose& goal, Duration elapsed) const {
  const double t = to_seconds(elapsed);
  return limit_step(before, goal, options_.base_speed * t, options_.base_turn_speed * t);
}

}  // namespace prehend::mapping
