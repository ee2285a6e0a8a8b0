// What a pad tells of what presses on it: the mean of what jumps, at once that something touches,
// and a slip once it lasts.
#include "services/simulation/core/touch_sense.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace prehend::simulation {
namespace {

using Eigen::Vector3d;

constexpr double step = 0.002;  // s
const Pose X_WB =
    make_pose(Vector3d(0.1, 0.2, 0.3),
              Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix());

grasping::Touch touch(double pressure, double sideways, double slip) {
  return {.link = 1,
          .p_W = Vector3d(0.1, 0.2, 0.4),
          .normal_W = Vector3d::UnitZ(),
          .force_W = Vector3d(sideways, 0, pressure),
          .slip_W = Vector3d(slip, 0, 0),
          .friction = 0.5};
}

TEST(TouchSense, TellsTheMeanOfWhatJumpsInTheFrameOfTheBase) {
  TouchSense sense(3, step);
  Random random(1);
  for (int i = 0; i < 500; ++i) sense.update({touch(random.uniform() < 0.5 ? 6 : 14, 2, 0)}, X_WB);
  const PadTouch& pad = sense.pads()[1];
  EXPECT_NEAR(pad.pressure, 10, 3);
  EXPECT_NEAR((X_WB.linear() * pad.force_B).x(), 2, 1e-6);
  EXPECT_LT((X_WB * pad.p_BC - Vector3d(0.1, 0.2, 0.4)).norm(), 1e-9);
  EXPECT_NEAR(pad.friction_use, 2 / (0.5 * pad.pressure), 0.1);
  EXPECT_FALSE(sense.pads()[0].touching);
  EXPECT_EQ(sense.pads()[2].pressure, 0);
}

TEST(TouchSense, ATouchIsToldAtOnceAndForgottenWhenItIsOver) {
  TouchSense sense(3, step);
  sense.update({touch(1, 0, 0)}, X_WB);
  EXPECT_TRUE(sense.pads()[1].touching);
  EXPECT_LT(sense.pads()[1].pressure, 0.2);
  sense.update({}, X_WB);
  EXPECT_FALSE(sense.pads()[1].touching);
  for (int i = 0; i < 100; ++i) sense.update({}, X_WB);
  EXPECT_EQ(sense.pads()[1].pressure, 0);
  EXPECT_EQ(sense.pads()[1].force_B, Vector3d::Zero());
  EXPECT_EQ(sense.pads()[1].friction_use, 0);
}

TEST(TouchSense, ASlipIsOneOnceItLastsTenMilliseconds) {
  TouchSense sense(3, step);
  for (int i = 0; i < 5; ++i) sense.update({touch(1, 0.5, 0.006)}, X_WB);
  EXPECT_FALSE(sense.pads()[1].slipping) << "10 ms, and not longer";
  sense.update({touch(1, 0.5, 0.006)}, X_WB);
  EXPECT_TRUE(sense.pads()[1].slipping);
  EXPECT_NEAR(sense.pads()[1].slip, 0.006, 1e-12);
  sense.update({touch(1, 0.5, 0.004)}, X_WB);
  EXPECT_FALSE(sense.pads()[1].slipping);
}

}  // namespace
}  // namespace prehend::simulation
