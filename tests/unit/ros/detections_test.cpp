// What the camera recognises, and how a grasp was judged, is what the types in idl/ros2 say.
#include "services/ros/core/detections.hpp"

#include <gtest/gtest.h>

#include "services/ros/core/diagnostics.hpp"
#include "tests/support/ros_values.hpp"

namespace prehend::ros {
namespace {

using test::count;
using test::in;
using test::list;
using test::number;
using test::ros_value;
using test::text;
using test::Value;

Detection cup() {
  Detection made{.stamp_ns = 2'500'000'000,
                 .track = 7,
                 .name = "Cup",
                 .probability = 0.75,
                 .X_WO = make_pose(Eigen::Vector3d(0.1, 0.2, 0.3)),
                 .size = {0.06, 0.06, 0.1}};
  for (std::size_t i = 0; i < 16; ++i) made.covariance[i] = static_cast<double>(i + 1);
  return made;
}

TEST(RosDetections, DetectionsAreBoxesInTheTablesFrame) {
  const Value message = ros_value("vision_msgs::msg::dds_::Detection3DArray_",
                                  detections_message(3'000'000'000, "table", {cup(), cup()}));
  EXPECT_EQ(std::get<std::int64_t>(in(message, {"header_", "stamp_", "sec_"}).content), 3);
  ASSERT_EQ(list(message, {"detections_"}).size(), 2U);
  const Value& one = list(message, {"detections_"})[1];
  EXPECT_EQ(count(one, {"header_", "stamp_", "nanosec_"}), 500'000'000U);
  EXPECT_EQ(text(one, {"header_", "frame_id_"}), "table");
  EXPECT_EQ(text(one, {"id_"}), "7");
  EXPECT_EQ(number(in(one, {"bbox_", "center_", "position_", "y_"})), 0.2);
  EXPECT_EQ(number(in(one, {"bbox_", "size_", "z_"})), 0.1);
  const Value& result = list(one, {"results_"}).at(0);
  EXPECT_EQ(text(result, {"hypothesis_", "class_id_"}), "Cup");
  EXPECT_EQ(number(in(result, {"hypothesis_", "score_"})), 0.75);
  // x, y, z and the turn about z, of six.
  const auto& covariance = list(result, {"pose_", "covariance_"});
  ASSERT_EQ(covariance.size(), 36U);
  EXPECT_EQ(number(covariance[0]), 1);
  EXPECT_EQ(number(covariance[5]), 4);
  EXPECT_EQ(number(covariance[14]), 11);
  EXPECT_EQ(number(covariance[35]), 16);
  EXPECT_EQ(number(covariance[21]), 0);
}

TEST(RosDetections, NothingSeenIsSaid) {
  const Value message =
      ros_value("vision_msgs::msg::dds_::Detection3DArray_", detections_message(1, "table", {}));
  EXPECT_TRUE(list(message, {"detections_"}).empty());
}

TEST(RosDiagnostics, AVerdictIsOkOrAWarning) {
  for (const bool good : {true, false}) {
    const Value message = ros_value(
        "diagnostic_msgs::msg::dds_::DiagnosticArray_",
        diagnostics_message(
            5,
            {.good = good, .name = "a", .message = "m", .hardware = "h", .values = {{"k", "v"}}}));
    const Value& status = list(message, {"status_"}).at(0);
    EXPECT_EQ(count(status, {"level_"}), good ? 0U : 1U);
    EXPECT_EQ(text(status, {"name_"}), "a");
    EXPECT_EQ(text(list(status, {"values_"}).at(0), {"value_"}), "v");
  }
}

}  // namespace
}  // namespace prehend::ros
