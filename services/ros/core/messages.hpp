#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "common/ros2/cdr.hpp"

/// Messages of ROS 2 that nobody else needs; see common/ros2. Pure.
namespace prehend::ros {

using ros2::Bytes;

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
