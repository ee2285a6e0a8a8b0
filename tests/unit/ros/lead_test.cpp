// Whose poses lead the base, and where to: one node at a time, in the table's frame, not late.
#include <gtest/gtest.h>

#include <string>

#include "services/ros/core/one_speaker.hpp"
#include "services/ros/core/wrist_goal.hpp"

namespace prehend::ros {
namespace {

using std::chrono::milliseconds;

const Time now = from_ns(1'700'000'000'000'000'000);

ros2::StampedPose pose(Duration after, const std::string& frame = "table") {
  return {.stamp_ns = to_ns(now + after),
          .frame = frame,
          .X_FB = make_pose(Eigen::Vector3d(0.1, 0.2, 0.3))};
}

TEST(WristGoal, IsInTheTablesFrame) {
  ASSERT_TRUE(wrist_goal(pose({}), now));
  EXPECT_EQ(wrist_goal(pose({}), now)->translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
  for (const char* frame : {"", "base_link", "Table", "table\x1b[2J"}) {
    const auto refused = wrist_goal(pose({}, frame), now);
    ASSERT_FALSE(refused) << frame;
    EXPECT_EQ(refused.error().message().find('\x1b'), std::string::npos);
  }
}

TEST(WristGoal, IsOfNow) {
  EXPECT_TRUE(wrist_goal(pose(milliseconds(-499)), now));
  EXPECT_TRUE(wrist_goal(pose(milliseconds(499)), now));
  EXPECT_FALSE(wrist_goal(pose(milliseconds(-501)), now));
  EXPECT_FALSE(wrist_goal(pose(milliseconds(501)), now));
  ros2::StampedPose without = pose({});
  without.stamp_ns = 0;
  EXPECT_TRUE(wrist_goal(without, now));
}

TEST(OneSpeaker, TheFirstIsFollowedUntilItIsSilent) {
  OneSpeaker<int> speaker;
  EXPECT_TRUE(speaker.hear(1, now));
  EXPECT_FALSE(speaker.hear(2, now + milliseconds(100)));
  EXPECT_TRUE(speaker.hear(1, now + milliseconds(400)));
  EXPECT_FALSE(speaker.hear(2, now + milliseconds(899)));
  EXPECT_TRUE(speaker.hear(2, now + milliseconds(900)));
  EXPECT_FALSE(speaker.hear(1, now + milliseconds(901)));
}

}  // namespace
}  // namespace prehend::ros
