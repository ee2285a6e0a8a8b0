#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/gate/limits.hpp"

namespace prehend::gate {

/// Where a hand is, or shall be.
struct Place {
  Eigen::VectorXd dof;  // rad or m
  Pose X_WB = Pose::Identity();
  /// What the drives of each DoF may use to get there, N m or N; empty: as much as the gate allows.
  Eigen::VectorXd effort = {};
};

/// What of a command was cut off.
enum class Cut {
  joint_range,
  joint_speed,
  joint_acceleration,
  effort,
  box,
  base_speed,
  base_acceleration
};
inline constexpr std::size_t cuts = 7;
std::string_view to_string(Cut cut);

/// What is left of a command; whatever was not cut is the same to the last bit. It always says its
/// effort.
struct Passed {
  Place place;
  std::array<bool, cuts> cut{};

  bool has(Cut which) const { return cut[static_cast<std::size_t>(which)]; }
};

/// Something with a velocity: a joint, the base's place, its turn. Braking is free, for a stop must
/// not wait; what becomes faster does so within its acceleration. What is cut stays on its way: a
/// base never leaves the line between two places of its box.
class Axis {
 public:
  static constexpr double max_reserve = 0.05;  // s, of acceleration

  /// At rest since so many seconds; what it may gain of speed comes back only with time.
  void rest(double t = max_reserve);
  /// So much of the way as may be gone in this time, s.
  Eigen::Vector3d go(const Eigen::Vector3d& way, double t, const MotionLimit& limit);
  bool too_fast() const { return too_fast_; }  // the last way, for its speed
  bool too_hard() const { return too_hard_; }  // for its acceleration

 private:
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double reserve_ = 0;  // s, of acceleration
  bool too_fast_ = false, too_hard_ = false;
};

/// Cuts a stream of places to the limits. Pure.
///
/// Time is what stamps say, since messages come when they like; but a stream never has more of it
/// than has passed here, and 300 ms. So in any time T a joint moves at most speed · (T + 300 ms),
/// and gains at most acceleration · (T + 350 ms) of speed.
class MotionLimiter {
 public:
  explicit MotionLimiter(Limits limits);

  /// The next place counts from here, at rest. That gives no time that has not passed: however
  /// often it is started, the bounds above hold. Before the first start a place is taken as it is,
  /// but for ranges: nobody knows where the hand is.
  void start(const Place& from);

  /// stamp: when it was meant. now: by the clock here.
  Passed step(const Place& wanted, Time stamp, Time now);

  const std::optional<Place>& place() const { return place_; }
  const Limits& limits() const { return limits_; }

 private:
  double elapsed(Time stamp, Time now);
  void bound(Passed& passed) const;
  void move(Passed& passed, double t);

  Limits limits_;
  std::optional<Place> place_;
  std::vector<Axis> joints_;
  Axis base_, turn_;
  bool rested_ = true;       // stamps begin with the next place
  Time stamp_{};             // the newest one
  std::optional<Time> now_;  // when the last place came
  Duration left_{};          // time that has passed here and was not used
};

}  // namespace prehend::gate
