#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/ros2/cdr.hpp"

namespace prehend::ros2 {

/// geometry_msgs/PoseStamped: where something stands in a frame.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  std::string frame = {};
  Pose X_FB = Pose::Identity();
};
Bytes pose_stamped(const StampedPose& pose);
/// All numbers are finite, and the rotation is one.
Expected<StampedPose> parse_pose_stamped(std::span<const std::uint8_t> bytes);

/// Where the poses of a geometry_msgs/PoseArray are, m, without their turns, which some trackers
/// leave out.
struct Points {
  std::int64_t stamp_ns = 0;
  std::string frame = {};
  std::vector<Eigen::Vector3d> points;
};
Bytes pose_array(const Points& points);
/// Numbers may be other than finite.
Expected<Points> parse_pose_array(std::span<const std::uint8_t> bytes);

}  // namespace prehend::ros2
