#include "services/robot/core/ros2_control_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/ros2/joints.hpp"

namespace prehend::robot::ros2_control {
namespace {

constexpr double margin = 0.1;       // rad, that a joint may be past its range
constexpr double near = 0.02;        // rad: there
constexpr double still = 0.03;       // rad/s
constexpr double far = 0.5;          // rad, but at most a third of the range
constexpr double faster = 5;         // than the hand's fastest no joint is
constexpr double periods_ahead = 2;  // of commands, until a point is to be reached

}  // namespace

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options) {
  return std::make_unique<Driver>(hand, options);
}

Driver::Driver(const model::HandModel& hand, const DriverOptions& options)
    : hand_(hand), options_(options) {
  for (const model::HandDof& dof : hand.dofs())
    motions_.push_back({.joint = hand.joints()[static_cast<std::size_t>(dof.joint)].name});
}

const model::HandDof& Driver::dof_of(const Motion& motion) const {
  return hand_.dofs()[static_cast<std::size_t>(&motion - motions_.data())];
}

void Driver::connected(Time now) {
  joined_ = true;
  known_ = false;
  silence_.end(now);
  if (phase_ == Phase::offline) trouble_ = "nobody tells its joint states";
}

void Driver::disconnected(const std::string& why) {
  joined_ = known_ = commanded_ = false;
  be(Phase::offline, why);
}

std::string Driver::step(std::string_view heard, Time now) {
  if (!joined_) return {};
  silence_.listen(now);
  if (!heard.empty()) hear(heard, now);
  if (phase_ != Phase::ready && phase_ != Phase::homing) return {};
  if (const auto why = what_is_wrong(now)) {
    const std::string said = farewell();
    be(Phase::faulted, *why);
    known_ = commanded_ = false;
    return said;
  }
  if (!commanded_ || now - told_ < seconds(1 / options_.rate)) return {};
  told_ = now;
  return tell();
}

/// All stay where they were seen last.
std::string Driver::farewell() {
  if (!commanded_) return {};
  for (Motion& motion : motions_) motion.goal = motion.position;
  return tell();
}

/// Its encoders are absolute, or it would not tell positions.
void Driver::home() {
  if (phase_ == Phase::ready) be(Phase::homing);
}

void Driver::follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time) {
  commanded_ = true;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const auto d = static_cast<Eigen::Index>(i);
    const auto& joint = hand_.joints()[static_cast<std::size_t>(hand_.dofs()[i].joint)];
    motions_[i].goal = dof[d];
    motions_[i].share =
        effort.size() > d ? std::clamp(std::abs(effort[d]) / joint.max_torque, 0.0, 1.0) : 1;
  }
}

void Driver::hold() {
  if (phase_ == Phase::homing) be(Phase::ready);
  for (Motion& motion : motions_) {
    const double squeeze = motion.kept.stalled() ? std::abs(dof_of(motion).squeeze) : 0;
    motion.goal = std::clamp(motion.goal, motion.position - squeeze, motion.position + squeeze);
  }
}

void Driver::suspect(std::string why, Time now) {
  suspicion_ = std::move(why);
  suspected_ = now;
}

/// Others may tell of other joints on the same topic: those messages are theirs.
void Driver::hear(std::string_view message, Time now) {
  const auto state = ros2::parse_joint_state(
      {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  if (!state) {
    suspect("its joint states are damaged", now);
    return count_reject("joint state " + state.error().what);
  }
  std::vector<std::size_t> at;
  std::string missing;
  for (const Motion& motion : motions_) {
    const auto found = std::find(state->names.begin(), state->names.end(), motion.joint);
    if (found == state->names.end()) missing += (missing.empty() ? "" : ", ") + motion.joint;
    at.push_back(static_cast<std::size_t>(found - state->names.begin()));
  }
  if (!missing.empty()) {
    suspect("its joint states do not name " + missing, now);
    if (phase_ == Phase::offline) trouble_ = suspicion_;
    return;
  }
  std::vector<double> positions;
  for (const std::size_t i : at) positions.push_back(state->positions[i]);
  if (known_ && !is_plausible(positions, now)) {
    suspect("its joint states jump", now);
    // What it was known by was perhaps no sound state itself.
    if (phase_ == Phase::faulted && now - silence_.began() > options_.lost_after) known_ = false;
    return count_reject("joint state jumps");
  }
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    std::optional<double> velocity;
    if (!state->velocities.empty()) velocity = state->velocities[at[i]];
    if (!state->efforts.empty()) motions_[i].effort = state->efforts[at[i]];
    observe(motions_[i], positions[i], velocity, now);
  }
  tells_effort_ = !state->efforts.empty();
  silence_.end(now);
  if (!std::exchange(known_, true)) {
    for (Motion& motion : motions_) {
      motion.goal = motion.position;
      motion.kept.forget();
    }
    identity_ = fmt::format("{} joints of ros2_control", motions_.size());
  }
  const auto wrong = out_of_range();
  be(wrong ? Phase::faulted : Phase::ready, wrong.value_or(""));
  publish(now);
}

bool Driver::is_plausible(const std::vector<double>& positions, Time now) const {
  const double dt = to_seconds(now - silence_.began());
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[i];
    const double most = margin * model::radian_of(dof) + faster * dof.max_velocity * dt;
    if (std::abs(positions[i] - motions_[i].position) > most) return false;
  }
  return true;
}

void Driver::observe(Motion& motion, double position, std::optional<double> velocity, Time now) {
  const double dt = to_seconds(now - silence_.began());
  const double moved = known_ && dt > 0 ? (position - motion.position) / dt : 0;
  const bool sound = velocity && std::abs(*velocity) <= faster * dof_of(motion).max_velocity;
  motion.velocity = sound ? *velocity : moved;
  motion.position = position;
  const double radian = model::radian_of(dof_of(motion));
  motion.kept.observe(std::abs(motion.goal - position) < near * radian ||
                          std::abs(motion.velocity) > still * radian,
                      now);
}

std::optional<std::string> Driver::out_of_range() const {
  for (const Motion& motion : motions_) {
    const model::HandDof& dof = dof_of(motion);
    const double slack = margin * model::radian_of(dof);
    if (motion.position < dof.lower - slack || motion.position > dof.upper + slack)
      return fmt::format("{} is at {:.3f}, outside its range", motion.joint, motion.position);
  }
  return std::nullopt;
}

std::optional<std::string> Driver::what_is_wrong(Time now) const {
  if (silence_.listened() > options_.lost_after)
    return now - suspected_ > options_.lost_after / 2 ? "its joint states have fallen silent"
                                                      : suspicion_;
  for (const Motion& motion : motions_) {
    const model::HandDof& dof = dof_of(motion);
    const double most = std::min(far * model::radian_of(dof), (dof.upper - dof.lower) / 3);
    if (motion.kept.stuck() && std::abs(motion.goal - motion.position) > most)
      return motion.joint + " is stuck";
  }
  return std::nullopt;
}

void Driver::publish(Time now) {
  const auto count = static_cast<Eigen::Index>(motions_.size());
  Reading reading{now, Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count), {}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Motion& motion = motions_[static_cast<std::size_t>(i)];
    reading.dof[i] = motion.position;
    reading.velocity[i] = motion.velocity;
    reading.effort[i] = motion.effort;
  }
  if (!tells_effort_) reading.effort.resize(0);
  reading_ = std::move(reading);
}

/// A trajectory knows no effort: what is kept from moving is sent no farther ahead than it shall
/// press.
double Driver::bounded(const Motion& motion) const {
  if (!motion.kept.stalled()) return motion.goal;
  const double press = motion.share * std::abs(dof_of(motion).squeeze);
  return std::clamp(motion.goal, motion.position - press, motion.position + press);
}

std::string Driver::tell() const {
  ros2::JointTrajectory trajectory;
  auto& point = trajectory.points.emplace_back();
  point.time_from_start = seconds(periods_ahead / options_.rate);
  for (const Motion& motion : motions_) {
    trajectory.names.push_back(motion.joint);
    point.positions.push_back(bounded(motion));
  }
  const ros2::Bytes bytes = ros2::joint_trajectory(trajectory);
  return {bytes.begin(), bytes.end()};
}

}  // namespace prehend::robot::ros2_control
