#include "services/ros/core/wrist_goal.hpp"

#include <fmt/format.h>

#include "common/base/printable.hpp"
#include "common/base/time_between.hpp"

namespace prehend::ros {
namespace {

constexpr Duration max_pose_age = std::chrono::milliseconds(500);  // of a stamp
constexpr std::size_t max_frame_name = 64;  // of somebody else's name, in a message

}  // namespace

Expected<Pose> wrist_goal(const ros2::StampedPose& pose, Time now) {
  if (pose.frame != table_frame)
    return fail(
        fmt::format("is in the frame «{}»", printable(pose.frame.substr(0, max_frame_name))), {},
        fmt::format("give it in the frame {}, see /tf", table_frame));
  const Time stamp = pose.stamp_ns == 0 ? now : from_ns(pose.stamp_ns);
  if (!is_within(stamp, now, max_pose_age))
    return fail(fmt::format("has a stamp {:.1f} s away from now", to_seconds(between(stamp, now))),
                {}, "do both sides have the same clock?");
  return pose.X_FB;
}

}  // namespace prehend::ros
