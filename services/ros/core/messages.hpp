#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"

/// Messages of ROS 2 as bytes on the wire (idl/ros2): little endian, behind the four bytes that say
/// so. Pure.
namespace prehend::ros {

using Bytes = std::vector<std::uint8_t>;

/// sensor_msgs/JointState. Velocities and efforts may be left out.
struct Joints {
  std::int64_t stamp_ns = 0;
  std::string frame;
  std::vector<std::string> names;
  std::vector<double> positions, velocities, efforts;
};
Bytes joint_state(const Joints& joints);

/// Where the frame `child` stands in the frame `parent`.
struct Transform {
  std::int64_t stamp_ns = 0;
  std::string parent, child;
  Pose X_PC;
};
/// tf2_msgs/TFMessage.
Bytes tf_message(const std::vector<Transform>& transforms);

/// std_msgs/String.
Bytes text_message(std::string_view text);

/// The base of a hand in the table's frame, and each other link in its parent's.
std::vector<Transform> transforms_of(const model::HandModel& model, const Pose& X_WB,
                                     const Eigen::VectorXd& joints, std::string_view table,
                                     std::int64_t stamp_ns);

}  // namespace prehend::ros
