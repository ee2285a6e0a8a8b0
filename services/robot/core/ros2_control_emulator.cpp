#include "services/robot/core/ros2_control_emulator.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::robot::ros2_control {
namespace {

constexpr Duration tells_every = std::chrono::milliseconds(10);
constexpr double may_be_faster = 1.5;  // than the hand's fastest a drive is

}  // namespace

Emulator::Emulator(const model::HandModel& hand, const EmulatedOptions& options)
    : options_(options) {
  const Eigen::VectorXd& open = hand.postures().at("open");
  for (std::size_t d = 0; d < hand.dofs().size(); ++d) {
    const model::HandDof& dof = hand.dofs()[d];
    const double at = open[static_cast<Eigen::Index>(d)];
    joints_.push_back({.name = hand.joints()[static_cast<std::size_t>(dof.joint)].name,
                       .position = at,
                       .driven = at,
                       .squeeze = std::abs(dof.squeeze),
                       .fastest = may_be_faster * dof.max_velocity});
  }
  begun_from_ = open;
}

std::string Emulator::receive(std::string_view bytes, Duration now) {
  const auto heard = ros2::parse_joint_trajectory(
      {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  std::vector<std::size_t> at;
  if (heard)
    for (const Joint& joint : joints_) {
      const auto found = std::find(heard->names.begin(), heard->names.end(), joint.name);
      if (found != heard->names.end())
        at.push_back(static_cast<std::size_t>(found - heard->names.begin()));
    }
  if (!heard || heard->names.size() != joints_.size() || at.size() != joints_.size()) {
    ++refused_;
    return {};
  }
  trajectory_ = *heard;
  for (auto& point : trajectory_.points) {
    const std::vector<double> positions = point.positions;
    for (std::size_t i = 0; i < at.size(); ++i) point.positions[i] = positions[at[i]];
  }
  begun_ = now;
  begun_from_ = driven();
  return {};
}

/// From point to point on straight lines.
Eigen::VectorXd Emulator::wanted(Duration now) const {
  Eigen::VectorXd from = begun_from_;
  Duration since{};
  for (const auto& point : trajectory_.points) {
    const Eigen::VectorXd to = Eigen::Map<const Eigen::VectorXd>(
        point.positions.data(), static_cast<Eigen::Index>(point.positions.size()));
    const Duration t = now - begun_;
    if (t < point.time_from_start)
      return from +
             (to - from) * (to_seconds(t - since) / to_seconds(point.time_from_start - since));
    from = to;
    since = point.time_from_start;
  }
  return from;
}

std::string Emulator::pass(Duration now) {
  const double dt = to_seconds(now - now_);
  now_ = now;
  const Eigen::VectorXd wanted_now = wanted(now);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const double most = joint.fastest * options_.velocity_scale * dt;
    joint.driven +=
        std::clamp(wanted_now[static_cast<Eigen::Index>(i)] - joint.driven, -most, most);
    joint.driven = std::clamp(joint.driven, joint.position - joint.squeeze - most,
                              joint.position + joint.squeeze + most);
    if (twin_ || joint.blocked) continue;
    joint.velocity = dt > 0 ? (joint.driven - joint.position) / dt : 0;
    joint.position = joint.driven;
  }
  if (now - told_ < tells_every) return {};
  told_ = now;
  ros2::Joints state{
      .stamp_ns = now.count(), .names = {}, .positions = {}, .velocities = {}, .efforts = {}};
  for (const Joint& joint : joints_) {
    state.names.push_back(joint.name);
    state.positions.push_back(joint.position);
    state.velocities.push_back(joint.blocked ? 0 : joint.velocity);
  }
  const ros2::Bytes bytes = ros2::joint_state(state);
  return {bytes.begin(), bytes.end()};
}

Eigen::VectorXd Emulator::driven() const {
  Eigen::VectorXd made(static_cast<Eigen::Index>(joints_.size()));
  for (std::size_t i = 0; i < joints_.size(); ++i)
    made[static_cast<Eigen::Index>(i)] = joints_[i].driven;
  return made;
}

Eigen::VectorXd Emulator::measured() const {
  Eigen::VectorXd made(static_cast<Eigen::Index>(joints_.size()));
  for (std::size_t i = 0; i < joints_.size(); ++i)
    made[static_cast<Eigen::Index>(i)] = joints_[i].position;
  return made;
}

void Emulator::measure(const Eigen::VectorXd& dof) {
  twin_ = true;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double now = dof[static_cast<Eigen::Index>(i)];
    joints_[i].position = now;
  }
}

/// Its controller holds where it finds the joints.
void Emulator::restart() {
  trajectory_.points.clear();
  begun_from_ = measured();
}

void Emulator::block(std::size_t dof, bool blocked) {
  joints_.at(dof).blocked = blocked;
}

}  // namespace prehend::robot::ros2_control
