#include "common/gate/motion_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/named_values.hpp"
#include "common/base/time_between.hpp"

namespace prehend::gate {
namespace {

using Eigen::Vector3d;

/// Commands may be late by 200 ms and then no more, and one after a pause goes as far as in 100 ms.
constexpr Duration max_left = std::chrono::milliseconds(300);
/// After a pause of any length one command goes as far as in this time, as mapping's do.
constexpr Duration max_step = std::chrono::milliseconds(100);
/// The first command from a known place has this much time at most.
constexpr Duration first_step = std::chrono::milliseconds(20);
constexpr double rounding = 1e-9;  // relative, of speeds; m and rad, of ways in no time

constexpr auto cut_names =
    named_values<Cut>({{Cut::joint_range, "command cut: joint range"},
                       {Cut::joint_speed, "command cut: joint speed"},
                       {Cut::joint_acceleration, "command cut: joint acceleration"},
                       {Cut::effort, "command cut: effort"},
                       {Cut::box, "command cut: box of the base"},
                       {Cut::base_speed, "command cut: base speed"},
                       {Cut::base_acceleration, "command cut: base acceleration"}});

/// What v has beyond what braking alone makes of a velocity.
double gain(const Vector3d& velocity, const Vector3d& v) {
  const double square = velocity.squaredNorm();
  const double kept = square > 0 ? std::clamp(v.dot(velocity) / square, 0.0, 1.0) : 0.0;
  return (v - kept * velocity).norm();
}

/// The largest share of v that gains no more than `most`. Along v the gain never falls, for it is
/// the distance from a convex set that contains 0.
double largest_share(const Vector3d& velocity, const Vector3d& v, double most) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (gain(velocity, middle * v) > most ? high : low) = middle;
  }
  return low;
}

/// The rotation of A into B, as a vector in W.
Vector3d turn_between(const Pose& A, const Pose& B) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(B.linear() * A.linear().transpose()));
  return turn.angle() * turn.axis();
}

}  // namespace

std::string_view to_string(Cut cut) {
  return cut_names.name(cut, "command cut");
}

void Axis::rest(double t) {
  velocity_.setZero();
  reserve_ = std::min(reserve_ + t, max_reserve);
}

Vector3d Axis::go(const Vector3d& way, double t, const MotionLimit& limit) {
  too_fast_ = too_hard_ = false;
  if (t <= 0) {
    too_fast_ = way.norm() > rounding;
    return too_fast_ ? Vector3d(Vector3d::Zero()) : way;
  }
  reserve_ = std::min(reserve_ + t, max_reserve);
  Vector3d next = way / t;
  if (const double speed = next.norm(); speed > limit.speed * (1 + rounding)) {
    next *= limit.speed / speed;
    too_fast_ = true;
  }
  const double most = limit.acceleration * reserve_;
  if (gain(velocity_, next) > most * (1 + rounding)) {
    next *= largest_share(velocity_, next, most);
    too_hard_ = true;
  }
  reserve_ = std::max(0.0, reserve_ - gain(velocity_, next) / limit.acceleration);
  velocity_ = next;
  return too_fast_ || too_hard_ ? Vector3d(next * t) : way;
}

MotionLimiter::MotionLimiter(Limits limits)
    : limits_(std::move(limits)), joints_(limits_.joint.size()) {}

void MotionLimiter::start(const Place& from) {
  place_ = from;
  rested_ = true;
}

/// The time that this place has, s.
double MotionLimiter::elapsed(Time stamp, Time now) {
  const Duration passed =
      now_ ? std::max(between(*now_, now), Duration::zero()) : Duration(max_left);
  left_ = left_ < max_left - passed ? left_ + passed : max_left;
  now_ = now_ ? std::max(*now_, now) : now;
  Duration claimed = std::clamp(between(stamp_, stamp), Duration::zero(), max_step);
  const bool rested = std::exchange(rested_, false);
  if (rested) claimed = std::min(passed, first_step);
  const Duration used = std::min(claimed, left_);
  if (rested) {
    const double rest = to_seconds(std::max(passed - used, Duration::zero()));
    for (Axis& joint : joints_) joint.rest(rest);
    base_.rest(rest);
    turn_.rest(rest);
  }
  stamp_ = rested ? stamp : std::max(stamp_, stamp);
  left_ -= used;
  return to_seconds(used);
}

void MotionLimiter::bound(Passed& passed) const {
  Place& place = passed.place;
  const auto cut = [&](Cut which) { passed.cut[static_cast<std::size_t>(which)] = true; };
  const Eigen::VectorXd within = place.dof.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  if ((within - place.dof).cwiseAbs().maxCoeff() > rounding) cut(Cut::joint_range);
  place.dof = within;
  if (place.effort.size() == 0) {
    place.effort = limits_.effort;
  } else if ((place.effort.array() > limits_.effort.array()).any()) {
    place.effort = place.effort.cwiseMin(limits_.effort);
    cut(Cut::effort);
  }
  const Vector3d inside =
      place.X_WB.translation().cwiseMax(limits_.box_lower).cwiseMin(limits_.box_upper);
  if (inside != place.X_WB.translation()) cut(Cut::box);
  place.X_WB.translation() = inside;
}

void MotionLimiter::move(Passed& passed, double t) {
  Place& place = passed.place;
  const auto cut = [&](const Axis& axis, Cut fast, Cut hard) {
    passed.cut[static_cast<std::size_t>(fast)] |= axis.too_fast();
    passed.cut[static_cast<std::size_t>(hard)] |= axis.too_hard();
    return axis.too_fast() || axis.too_hard();
  };
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Vector3d way(place.dof[i] - place_->dof[i], 0, 0);
    const Vector3d gone = joints_[k].go(way, t, limits_.joint[k]);
    if (cut(joints_[k], Cut::joint_speed, Cut::joint_acceleration))
      place.dof[i] = place_->dof[i] + gone.x();
  }
  const Vector3d gone =
      base_.go(place.X_WB.translation() - place_->X_WB.translation(), t, limits_.base);
  if (cut(base_, Cut::base_speed, Cut::base_acceleration))
    place.X_WB.translation() = place_->X_WB.translation() + gone;
  const Vector3d turned = turn_.go(turn_between(place_->X_WB, place.X_WB), t, limits_.turn);
  if (cut(turn_, Cut::base_speed, Cut::base_acceleration)) {
    const double angle = turned.norm();
    place.X_WB.linear() =
        angle > 0 ? Eigen::Matrix3d(Eigen::AngleAxisd(angle, turned / angle).toRotationMatrix() *
                                    place_->X_WB.linear())
                  : Eigen::Matrix3d(place_->X_WB.linear());
  }
}

Passed MotionLimiter::step(const Place& wanted, Time stamp, Time now) {
  Passed passed{wanted, {}};
  bound(passed);
  if (!place_) start(passed.place);
  const double t = elapsed(stamp, now);
  move(passed, t);
  place_ = passed.place;
  return passed;
}

}  // namespace prehend::gate
