#include "services/simulation/core/touch_sense.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::simulation {
namespace {

using Eigen::Vector3d;

constexpr double filter_time = 0.02;   // s; at 500 Hz it leaves 2 % of the solver's noise
constexpr double nothing = 0.005;      // N: what is left of a touch that is over
constexpr double slides = 0.005;       // m/s
constexpr double slides_after = 0.01;  // s

/// What presses on one link in one step.
struct Sum {
  Vector3d force_W = Vector3d::Zero(), moment_W = Vector3d::Zero();
  double pressure = 0, allowed = 0, slip = 0;
};

}  // namespace

TouchSense::TouchSense(std::size_t links, double time_step, int hand)
    : time_step_(time_step), hand_(hand), pads_(links), allowed_(links), slid_(links) {}

void TouchSense::update(const std::vector<grasping::Touch>& touches, const Pose& X_WB) {
  std::vector<Sum> sums(pads_.size());
  for (const grasping::Touch& touch : touches) {
    if (touch.hand != hand_) continue;
    Sum& sum = sums[static_cast<std::size_t>(touch.link)];
    const double pressure = touch.force_W.dot(touch.normal_W);
    sum.force_W += touch.force_W;
    sum.moment_W += pressure * touch.p_W;
    sum.pressure += pressure;
    sum.allowed += pressure * touch.friction;
    sum.slip += pressure * touch.slip_W.norm();
  }
  const double share = time_step_ / (filter_time + time_step_);
  const Pose X_BW = X_WB.inverse();
  for (std::size_t i = 0; i < pads_.size(); ++i) {
    PadTouch& pad = pads_[i];
    const Sum& sum = sums[i];
    pad.touching = sum.pressure > 0;
    pad.force_B += share * (X_BW.linear() * sum.force_W - pad.force_B);
    pad.pressure += share * (sum.pressure - pad.pressure);
    allowed_[i] += share * (sum.allowed - allowed_[i]);
    pad.slip = pad.touching ? sum.slip / sum.pressure : 0;
    slid_[i] = pad.slip > slides ? slid_[i] + time_step_ : 0;
    pad.slipping = slid_[i] > slides_after;
    if (pad.touching) pad.p_BC = X_BW * Vector3d(sum.moment_W / sum.pressure);
    if (!pad.touching && pad.pressure < nothing) pad = {}, allowed_[i] = 0;
    const double sideways =
        std::sqrt(std::max(0.0, pad.force_B.squaredNorm() - pad.pressure * pad.pressure));
    pad.friction_use = allowed_[i] > 0 ? std::min(1.0, sideways / allowed_[i]) : 0;
  }
}

}  // namespace prehend::simulation
