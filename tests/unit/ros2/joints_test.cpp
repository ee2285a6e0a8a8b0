// Messages of joints are what their types in idl/ros2 say, and come back as they went.
#include "common/ros2/joints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/ros_values.hpp"

namespace prehend::ros2 {
namespace {

using test::in;
using test::list;
using test::number;
using test::ros_value;
using test::Value;

Joints three() {
  return {.stamp_ns = -1,
          .frame = "palm",
          .names = {"a", "bcdef", ""},
          .positions = {0.5, -1, 2},
          .velocities = {},
          .efforts = {1, 2, 3}};
}

JointTrajectory two_points() {
  return {.stamp_ns = 7,
          .names = {"a", "bc"},
          .points = {{{0.25, -1}, std::chrono::milliseconds(20)},
                     {{1e-300, 3}, std::chrono::milliseconds(1500)}}};
}

/// The same as another machine may write it: each number the other way round.
Bytes turned(const Joints& joints) {
  Bytes made{0, 0, 0, 0};
  const auto put = [&](std::uint64_t value, std::size_t size) {
    while ((made.size() - 4) % size != 0) made.push_back(0);
    for (std::size_t i = size; i-- > 0;)
      made.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xff));
  };
  const auto text = [&](const std::string& t) {
    put(t.size() + 1, 4);
    made.insert(made.end(), t.begin(), t.end());
    made.push_back(0);
  };
  put(static_cast<std::uint64_t>(joints.stamp_ns / 1'000'000'000), 4);
  put(static_cast<std::uint64_t>(joints.stamp_ns % 1'000'000'000), 4);
  text(joints.frame);
  put(joints.names.size(), 4);
  for (const auto& name : joints.names) text(name);
  for (const auto* values : {&joints.positions, &joints.velocities, &joints.efforts}) {
    put(values->size(), 4);
    for (const double value : *values) put(std::bit_cast<std::uint64_t>(value), 8);
  }
  return made;
}

TEST(Ros2Joints, AStateIsReadAsItsTypeSays) {
  const Value state = ros_value("sensor_msgs::msg::dds_::JointState_", joint_state(three()));
  // Before 1970 the seconds are negative, what is added never is.
  EXPECT_EQ(std::get<std::int64_t>(in(state, {"header_", "stamp_", "sec_"}).content), -1);
  EXPECT_EQ(std::get<std::uint64_t>(in(state, {"header_", "stamp_", "nanosec_"}).content),
            999'999'999U);
  EXPECT_EQ(std::get<std::string>(in(state, {"header_", "frame_id_"}).content), "palm");
  ASSERT_EQ(list(state, {"name_"}).size(), 3U);
  EXPECT_EQ(std::get<std::string>(list(state, {"name_"})[1].content), "bcdef");
  ASSERT_EQ(list(state, {"position_"}).size(), 3U);
  EXPECT_EQ(number(list(state, {"position_"})[1]), -1);
  EXPECT_TRUE(list(state, {"velocity_"}).empty());
  EXPECT_EQ(number(list(state, {"effort_"})[2]), 3);
}

TEST(Ros2Joints, ATrajectoryIsReadAsItsTypeSays) {
  const Value value =
      ros_value("trajectory_msgs::msg::dds_::JointTrajectory_", joint_trajectory(two_points()));
  EXPECT_EQ(std::get<std::string>(list(value, {"joint_names_"})[1].content), "bc");
  const auto& points = list(value, {"points_"});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(number(list(points[0], {"positions_"})[1]), -1);
  EXPECT_TRUE(list(points[0], {"velocities_"}).empty());
  EXPECT_TRUE(list(points[0], {"effort_"}).empty());
  EXPECT_EQ(std::get<std::int64_t>(in(points[1], {"time_from_start_", "sec_"}).content), 1);
  EXPECT_EQ(std::get<std::uint64_t>(in(points[1], {"time_from_start_", "nanosec_"}).content),
            500'000'000U);
}

TEST(Ros2Joints, WhatWasWrittenIsReadBackFromEitherByteOrder) {
  const auto state = parse_joint_state(joint_state(three()));
  ASSERT_TRUE(state) << state.error().what;
  EXPECT_EQ(state->stamp_ns, -1);
  EXPECT_EQ(state->frame, "palm");
  EXPECT_EQ(state->names, three().names);
  EXPECT_EQ(state->positions, three().positions);
  EXPECT_TRUE(state->velocities.empty());
  EXPECT_EQ(state->efforts, three().efforts);
  Joints later = three();
  later.stamp_ns = 1'700'000'000'250'000'000;
  const auto other = parse_joint_state(turned(later));
  ASSERT_TRUE(other) << other.error().what;
  EXPECT_EQ(other->stamp_ns, later.stamp_ns);
  EXPECT_EQ(other->names, later.names);
  EXPECT_EQ(other->positions, later.positions);
  const auto trajectory = parse_joint_trajectory(joint_trajectory(two_points()));
  ASSERT_TRUE(trajectory) << trajectory.error().what;
  EXPECT_EQ(trajectory->names, two_points().names);
  ASSERT_EQ(trajectory->points.size(), 2U);
  EXPECT_EQ(trajectory->points[1].positions, two_points().points[1].positions);
  EXPECT_EQ(trajectory->points[1].time_from_start, std::chrono::milliseconds(1500));
}

TEST(Ros2Joints, EveryPieceOfAMessageIsRefused) {
  const Bytes state = joint_state(three()), trajectory = joint_trajectory(two_points());
  for (std::size_t n = 0; n < state.size(); ++n)
    EXPECT_FALSE(parse_joint_state(std::span(state).first(n))) << n;
  for (std::size_t n = 0; n < trajectory.size(); ++n)
    EXPECT_FALSE(parse_joint_trajectory(std::span(trajectory).first(n))) << n;
  Bytes other = state;
  other[1] = 3;  // parameter lists are something else
  EXPECT_FALSE(parse_joint_state(other));
}

TEST(Ros2Joints, WhatDoesNotFitItselfIsRefused) {
  const auto refused = [](auto change, const std::string& words) {
    Joints joints = three();
    change(joints);
    const auto parsed = parse_joint_state(joint_state(joints));
    ASSERT_FALSE(parsed) << words;
    EXPECT_NE(parsed.error().what.find(words), std::string::npos) << parsed.error().what;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](Joints& j) { j.positions.pop_back(); }, "a position for each joint");
  refused([](Joints& j) { j.efforts.pop_back(); }, "for some joints only");
  refused([](Joints& j) { j.names[2] = "a"; }, "twice");
  refused([&](Joints& j) { j.positions[0] = nan; }, "no numbers");
  // Efforts that nobody measures are left out.
  Joints joints = three();
  joints.efforts[1] = nan;
  EXPECT_TRUE(parse_joint_state(joint_state(joints)).value().efforts.empty());
  JointTrajectory back = two_points();
  std::swap(back.points[0].time_from_start, back.points[1].time_from_start);
  EXPECT_FALSE(parse_joint_trajectory(joint_trajectory(back)));
  back = two_points();
  back.points[1].positions.pop_back();
  EXPECT_FALSE(parse_joint_trajectory(joint_trajectory(back)));
  back = two_points();
  back.points[1].positions[0] = nan;
  EXPECT_FALSE(parse_joint_trajectory(joint_trajectory(back)));
}

}  // namespace
}  // namespace prehend::ros2
