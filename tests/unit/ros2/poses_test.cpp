// Poses are what their types in idl/ros2 say, and come back as they went.
#include "common/ros2/poses.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/ros_values.hpp"

namespace prehend::ros2 {
namespace {

using test::in;
using test::number;

const StampedPose given{
    .stamp_ns = 1'700'000'000'250'000'000,
    .frame = "table",
    .X_FB = make_pose(Eigen::Vector3d(1, 2, 3), Eigen::Quaterniond(0.6, 0, 0.8, 0))};

TEST(StampedPose, IsReadAsItsTypeSays) {
  const auto value = test::ros_value("geometry_msgs::msg::dds_::PoseStamped_", pose_stamped(given));
  EXPECT_EQ(std::get<std::string>(in(value, {"header_", "frame_id_"}).content), "table");
  EXPECT_EQ(number(in(value, {"pose_", "position_", "z_"})), 3);
  EXPECT_NEAR(number(in(value, {"pose_", "orientation_", "w_"})), 0.6, 1e-12);
  EXPECT_NEAR(number(in(value, {"pose_", "orientation_", "y_"})), 0.8, 1e-12);
}

TEST(StampedPose, ComesBackAsItWent) {
  const auto read = parse_pose_stamped(pose_stamped(given));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->stamp_ns, given.stamp_ns);
  EXPECT_EQ(read->frame, given.frame);
  EXPECT_TRUE(read->X_FB.isApprox(given.X_FB, 1e-12));
}

TEST(StampedPose, WhatIsNoneIsRefused) {
  const Bytes whole = pose_stamped(given);
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_FALSE(parse_pose_stamped(std::span(whole).first(n))) << n;
  StampedPose nowhere = given;
  nowhere.X_FB.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(parse_pose_stamped(pose_stamped(nowhere)));
  // As a message that nobody filled in: all numbers are zero.
  Bytes empty = whole;
  std::fill(empty.end() - 32, empty.end(), std::uint8_t{0});
  const auto refused = parse_pose_stamped(empty);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("rotation"), std::string::npos) << refused.error().what;
}

TEST(PoseArray, IsReadAsItsTypeSaysAndComesBack) {
  const Points points{7, "tracker", {{1, 2, 3}, {4, 5, 6}}};
  const Bytes bytes = pose_array(points);
  const auto value = test::ros_value("geometry_msgs::msg::dds_::PoseArray_", bytes);
  ASSERT_EQ(test::list(value, {"poses_"}).size(), 2U);
  EXPECT_EQ(number(in(test::list(value, {"poses_"})[1], {"position_", "y_"})), 5);
  EXPECT_EQ(number(in(test::list(value, {"poses_"})[1], {"orientation_", "w_"})), 1);
  const auto read = parse_pose_array(bytes);
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->points, points.points);
  EXPECT_EQ(read->stamp_ns, 7);
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(parse_pose_array(std::span(bytes).first(n))) << n;
}

}  // namespace
}  // namespace prehend::ros2
