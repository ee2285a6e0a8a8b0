#include "common/convert/detection.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/convert/convert.hpp"

namespace prehend::convert {
namespace {

TEST(DetectionMessage, WithoutAPoseIsNone) {
  v1::ObjectDetection message;
  message.X_WO(to_message(make_pose({0, 0, 0.2})));
  message.track(7);
  ASSERT_TRUE(from_message(message));
  EXPECT_EQ(from_message(message)->track, 7U);
  message.X_WO().position().x(std::nan(""));
  EXPECT_EQ(from_message(message).error().what, "pose of a detection not usable");
}

}  // namespace
}  // namespace prehend::convert
