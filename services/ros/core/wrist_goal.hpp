#pragma once

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/ros2/poses.hpp"

namespace prehend::ros {

/// The frame of the table, as nodes call it.
inline constexpr const char* table_frame = "table";

/// Where the hand's base shall stand: X_WB. Refused: a frame other than the table's, and a stamp
/// more than 0.5 s away from now; a stamp of 0 is now. Pure.
Expected<Pose> wrist_goal(const ros2::StampedPose& pose, Time now);

}  // namespace prehend::ros
