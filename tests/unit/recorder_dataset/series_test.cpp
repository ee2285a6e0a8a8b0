// Values between samples: straight for numbers and positions, at constant turning speed for
// orientations, the newest for what cannot be mixed; nothing is made up across a long gap.
#include "services/recorder/core/dataset/series.hpp"

#include <gtest/gtest.h>

#include "tests/unit/recorder_dataset/lead.hpp"

namespace prehend::recorder::dataset {
namespace {

TEST(Series, IsStraightBetweenSamples) {
  Numbers series;
  series.add(ms(0), Eigen::Vector2d(1, -1));
  series.add(ms(100), Eigen::Vector2d(3, 1));
  EXPECT_TRUE(at(series, ms(25)).isApprox(Eigen::Vector2d(1.5, -0.5), 1e-12));
  EXPECT_TRUE(at(series, ms(100)).isApprox(Eigen::Vector2d(3, 1), 1e-12));
}

TEST(Series, StandsStillOutsideItsSamples) {
  Numbers series;
  series.add(ms(0), Eigen::VectorXd::Constant(1, 5));
  series.add(ms(10), Eigen::VectorXd::Constant(1, 7));
  EXPECT_EQ(at(series, ms(-1000))[0], 5);
  EXPECT_EQ(at(series, ms(1000))[0], 7);
}

TEST(Series, DoesNotBridgeALongGap) {
  Numbers series;
  series.add(ms(0), Eigen::VectorXd::Constant(1, 0));
  series.add(ms(500), Eigen::VectorXd::Constant(1, 1));   // bridged
  series.add(ms(1001), Eigen::VectorXd::Constant(1, 9));  // not
  EXPECT_NEAR(at(series, ms(250))[0], 0.5, 1e-12);
  EXPECT_EQ(at(series, ms(1000))[0], 1);
  EXPECT_EQ(at(series, ms(1001))[0], 9);
}

TEST(Series, PassesByWhatIsNotLater) {
  Numbers series;
  series.add(ms(10), Eigen::VectorXd::Constant(1, 1));
  series.add(ms(10), Eigen::VectorXd::Constant(1, 2));
  series.add(ms(5), Eigen::VectorXd::Constant(1, 3));
  ASSERT_EQ(series.times.size(), 1u);
  EXPECT_EQ(at(series, ms(10))[0], 1);
}

// A third of the time is a third of the angle: what mixing the numbers of quaternions misses.
TEST(Series, TurnsAtConstantSpeed) {
  const Eigen::AngleAxisd whole(2.4, Eigen::Vector3d(1, 2, -1).normalized());
  Poses series;
  series.add(ms(0), Pose::Identity());
  series.add(ms(300), make_pose({3, 0, 0}, whole.toRotationMatrix()));
  const Pose third = at(series, ms(100));
  EXPECT_TRUE(third.translation().isApprox(Eigen::Vector3d(1, 0, 0), 1e-12));
  const Eigen::AngleAxisd expected(0.8, whole.axis());
  EXPECT_LT(angle_between(third.linear(), expected.toRotationMatrix()), 1e-7);
}

TEST(Series, TheNewestIsWhatWasThereByThen) {
  const std::vector<Time> times{ms(0), ms(100), ms(200)};
  EXPECT_EQ(newest(times, ms(-1)), 0u);
  EXPECT_EQ(newest(times, ms(99)), 0u);
  EXPECT_EQ(newest(times, ms(100)), 1u);
  EXPECT_EQ(newest(times, ms(5000)), 2u);
}

}  // namespace
}  // namespace prehend::recorder::dataset
