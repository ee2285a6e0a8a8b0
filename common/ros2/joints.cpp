#include "common/ros2/joints.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace prehend::ros2 {
namespace {

constexpr std::size_t point_bytes = 4 * 4 + 8;  // four empty sequences, and its time

bool are_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool are_all_different(const std::vector<std::string>& names) {
  return std::set<std::string>(names.begin(), names.end()).size() == names.size();
}

}  // namespace

Bytes joint_state(const Joints& joints) {
  CdrWriter made;
  made.stamp(joints.stamp_ns);
  made.put(joints.frame);
  made.put(joints.names);
  made.put(joints.positions);
  made.put(joints.velocities);
  made.put(joints.efforts);
  return std::move(made).bytes();
}

Expected<Joints> parse_joint_state(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  Joints made;
  made.stamp_ns = read.stamp();
  made.frame = read.text();
  made.names = read.texts();
  made.positions = read.reals();
  made.velocities = read.reals();
  made.efforts = read.reals();
  if (!read.good()) return fail("is no whole sensor_msgs/JointState", {}, type_hint);
  const std::size_t count = made.names.size();
  if (made.positions.size() != count) return fail("has other than a position for each joint");
  if ((!made.velocities.empty() && made.velocities.size() != count) ||
      (!made.efforts.empty() && made.efforts.size() != count))
    return fail("has a velocity or effort for some joints only");
  if (!are_all_different(made.names)) return fail("names a joint twice");
  // What is not measured some nodes tell as NaN.
  for (std::vector<double>* optional : {&made.velocities, &made.efforts})
    if (!are_finite(*optional)) optional->clear();
  if (!are_finite(made.positions)) return fail("has positions that are no numbers");
  return made;
}

Bytes joint_trajectory(const JointTrajectory& trajectory) {
  CdrWriter made;
  made.stamp(trajectory.stamp_ns);
  made.put(std::string_view());  // the frame
  made.put(trajectory.names);
  made.put(static_cast<std::uint32_t>(trajectory.points.size()));
  const std::vector<double> none;
  for (const auto& point : trajectory.points) {
    made.put(point.positions);
    for (int i = 0; i < 3; ++i) made.put(none);  // velocities, accelerations, efforts
    made.stamp(point.time_from_start.count());
  }
  return std::move(made).bytes();
}

Expected<JointTrajectory> parse_joint_trajectory(std::span<const std::uint8_t> bytes) {
  CdrReader read(bytes);
  JointTrajectory made;
  made.stamp_ns = read.stamp();
  (void)read.text();
  made.names = read.texts();
  made.points.resize(read.length(point_bytes));
  for (auto& point : made.points) {
    point.positions = read.reals();
    for (int i = 0; i < 3; ++i) (void)read.reals();
    point.time_from_start = Duration(read.stamp());
  }
  if (!read.good()) return fail("is no whole trajectory_msgs/JointTrajectory", {}, type_hint);
  if (!are_all_different(made.names)) return fail("names a joint twice");
  Duration last = Duration(-1);
  for (const auto& point : made.points) {
    if (point.positions.size() != made.names.size())
      return fail("has a point without a position for each joint");
    if (!are_finite(point.positions)) return fail("has positions that are no numbers");
    if (point.time_from_start <= last) return fail("has times that do not increase");
    last = point.time_from_start;
  }
  return made;
}

}  // namespace prehend::ros2
