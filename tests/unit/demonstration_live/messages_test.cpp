// What comes from the network and is no pose is refused where it comes in.
#include "services/demonstration/service/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/convert/convert.hpp"

namespace prehend::demonstration {
namespace {

TEST(DemonstrationMessages, PosesThatAreNoneAreRefused) {
  v1::HandPosture hand;
  hand.X_WH(convert::to_message(make_pose({0, 0, 0.2})));
  EXPECT_TRUE(hand_from_message(hand));
  hand.X_WH().position().x(std::nan(""));
  EXPECT_EQ(hand_from_message(hand).error().what, "pose of the hand not usable");
  v1::ObjectDetection detection;
  detection.X_WO(convert::to_message(make_pose({0, 0, 0.2})));
  EXPECT_TRUE(object_from_message(detection));
  detection.X_WO().orientation().w(0);
  EXPECT_EQ(object_from_message(detection).error().what, "pose of a detection not usable");
}

}  // namespace
}  // namespace prehend::demonstration
