#include "services/recorder/core/ease_in.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::recorder {
namespace {

constexpr double base_speed = 0.25;      // m/s
constexpr double base_turn_speed = 0.8;  // rad/s
// s(u) = 3u² - 2u³ is steepest in the middle: s'(1/2) = 3/2.
constexpr double steepest = 1.5;

}  // namespace

EaseIn::EaseIn(const model::HandModel& hand, HandPlace from, HandPlace to, double share)
    : from_(std::move(from)), to_(std::move(to)) {
  double time = (to_.X_WB.translation() - from_.X_WB.translation()).norm() / base_speed;
  time = std::max(time, angle_between(from_.X_WB.linear(), to_.X_WB.linear()) / base_turn_speed);
  for (Eigen::Index i = 0; i < to_.dof.size(); ++i)
    time = std::max(time, std::abs(to_.dof[i] - from_.dof[i]) /
                              hand.dofs()[static_cast<std::size_t>(i)].max_velocity);
  duration_ = seconds(steepest * time / share);
}

HandPlace EaseIn::at(Duration t) const {
  const double u =
      duration_.count() <= 0 ? 1 : std::clamp(to_seconds(t) / to_seconds(duration_), 0.0, 1.0);
  const double s = u * u * (3 - 2 * u);
  if (u >= 1) return to_;
  return {from_.dof + s * (to_.dof - from_.dof), interpolate(from_.X_WB, to_.X_WB, s)};
}

}  // namespace prehend::recorder
