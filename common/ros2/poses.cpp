#include "common/ros2/poses.hpp"

#include <utility>

namespace prehend::ros2 {

Bytes pose_stamped(const StampedPose& pose) {
  CdrWriter made;
  made.stamp(pose.stamp_ns);
  made.put(pose.frame);
  made.put(pose.X_FB);
  return std::move(made).bytes();
}

Expected<StampedPose> parse_pose_stamped(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  StampedPose made;
  made.stamp_ns = read.stamp();
  made.frame = read.text();
  const auto [p, q] = read.pose();
  if (!read.good()) return fail("is no whole geometry_msgs/PoseStamped", {}, type_hint);
  const auto X = checked_pose(p, q);
  if (!X) return tl::unexpected(X.error());
  made.X_FB = *X;
  return made;
}

Bytes pose_array(const Points& points) {
  CdrWriter made;
  made.stamp(points.stamp_ns);
  made.put(points.frame);
  made.put(static_cast<std::uint32_t>(points.points.size()));
  for (const Eigen::Vector3d& point : points.points) made.put(make_pose(point));
  return std::move(made).bytes();
}

Expected<Points> parse_pose_array(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t pose_bytes = 7 * sizeof(double);
  CdrReader read(bytes);
  Points made;
  made.stamp_ns = read.stamp();
  made.frame = read.text();
  made.points.resize(read.length(pose_bytes));
  for (Eigen::Vector3d& point : made.points) point = read.pose().first;
  if (!read.good()) return fail("is no whole geometry_msgs/PoseArray", {}, type_hint);
  return made;
}

}  // namespace prehend::ros2
