#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/pose.hpp"
#include "common/ros2/cdr.hpp"

namespace prehend::ros {

/// A recognised object, in the frame of the table.
struct Detection {
  std::int64_t stamp_ns = 0;
  std::uint32_t track = 0;
  std::string name;                     // in the catalogue
  double probability = 0;               // of the name, 0 to 1
  Pose X_WO = Pose::Identity();         // O: the middle of its bounding box
  Eigen::Vector3d size;                 // m, edges of that box along O's axes
  std::array<double, 16> covariance{};  // of x, y, z (m) and the turn about z (rad), row-major
};
/// vision_msgs/Detection3DArray, as since Humble: all objects that are seen; none, too. stamp_ns:
/// of the newest picture. Pure.
ros2::Bytes detections_message(std::int64_t stamp_ns, std::string_view frame,
                               const std::vector<Detection>& detections);

}  // namespace prehend::ros
