#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/ros2/cdr.hpp"

/// What nodes of ROS 2 say of joints, and tell them. Lengths of what was read fit each other, and
/// all numbers are finite. Pure.
namespace prehend::ros2 {

/// sensor_msgs/JointState. Velocities and efforts may be left out.
struct Joints {
  std::int64_t stamp_ns = 0;
  std::string frame = {};
  std::vector<std::string> names;
  std::vector<double> positions, velocities, efforts;
};
Bytes joint_state(const Joints& joints);
Expected<Joints> parse_joint_state(std::span<const std::uint8_t> bytes);

/// trajectory_msgs/JointTrajectory. A stamp of 0: it begins when it comes. No points: stop.
struct JointTrajectory {
  struct Point {
    std::vector<double> positions;
    Duration time_from_start{};
  };
  std::int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<Point> points;  // later and later
};
Bytes joint_trajectory(const JointTrajectory& trajectory);
Expected<JointTrajectory> parse_joint_trajectory(std::span<const std::uint8_t> bytes);

}  // namespace prehend::ros2
