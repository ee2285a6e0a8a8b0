#include <algorithm>
#include <cmath>

#include "services/robot/core/barrett_driver.hpp"

namespace prehend::robot::barrett {
namespace {

constexpr double gain = 12;                                      // 1/s
constexpr double smoothing = 0.5;                                // of the velocity, per sample
constexpr double near = 0.002;                                   // rad: there
constexpr double pushing = 0.06, still = 0.03;                   // rad/s, commanded and done
constexpr double far = 0.5;                                      // rad
constexpr Duration follows_for = std::chrono::milliseconds(80);  // without a newer target

}  // namespace

void MotorControl::observe(double position, Time now) {
  if (known_ && now > seen_) {
    const double v = (position - position_) / to_seconds(now - seen_);
    velocity_ += smoothing * (v - velocity_);
  }
  if (!known_) target_ = position;
  known_ = true;
  position_ = position;
  seen_ = now;
  watch(now);
}

void MotorControl::watch(Time now) {
  const double scale = limits_.counts_per_radian;
  // However gently, it goes on to press once it was kept from moving.
  const bool pushes = std::abs(commanded_) > (stalled() ? 0 : pushing * scale);
  const bool moves = std::abs(velocity_) > still * scale && velocity_ * commanded_ > 0;
  kept_.observe(!pushes || moves, now);
}

void MotorControl::follow(double target, double share, Time now) {
  const double dt = to_seconds(now - told_);
  ahead_ = dt > 0 && now - told_ < follows_for ? (target - target_) / dt : 0;
  ahead_ = std::clamp(ahead_, -limits_.speed, limits_.speed);
  target_ = target;
  share_ = std::clamp(share, 0.0, 1.0);
  told_ = now;
}

void MotorControl::hold() {
  ahead_ = 0;
  target_ = stalled()
                ? std::clamp(target_, position_ - limits_.squeeze, position_ + limits_.squeeze)
                : position_;
}

double MotorControl::command(Time now) {
  const double behind = target_ - position_;
  const double ahead = now - told_ < follows_for ? ahead_ : 0;
  double v = ahead + gain * behind;
  if (ahead == 0 && std::abs(behind) < near * limits_.counts_per_radian) v = 0;
  const bool still_pressing = stalled() && v * commanded_ > 0;
  const double most = still_pressing ? limits_.press * share_ : limits_.speed;
  commanded_ = std::clamp(v, -most, most);
  if (!still_pressing && stalled()) kept_.forget();
  return commanded_;
}

double MotorControl::effort() const {
  return stalled() ? std::clamp(commanded_ / limits_.press, -share_, share_) : 0;
}

bool MotorControl::stuck() const {
  return kept_.stuck() && std::abs(target_ - position_) > far * limits_.counts_per_radian;
}

}  // namespace prehend::robot::barrett
