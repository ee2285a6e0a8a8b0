// Scaling to [-1, 1] and back.
#include <gtest/gtest.h>

#include <limits>
#include <prehend/base/random.hpp>
#include <prehend/learning/scaling.hpp>

namespace prehend::learning {
namespace {

Eigen::MatrixXd samples() {
  Eigen::MatrixXd s(3, 4);
  s << 0.1, -0.12, 0.05, 0.0,      //
      0.015, 0.037, 0.024, 0.033,  //
      7, 7, 7, 7;
  return s;
}

TEST(Scaling, GivesEachFeatureTheWholeRange) {
  const auto scaling = Scaling::fit(samples(), ScalingKind::each_feature);
  ASSERT_TRUE(scaling);
  // The largest value becomes -1, the smallest +1 (1 − 2(v − min)/(max − min)), a constant one 0.
  const Eigen::VectorXd a = scaling->to_unit(samples().col(0));
  EXPECT_DOUBLE_EQ(a[0], -1);
  EXPECT_DOUBLE_EQ(a[1], 1);
  EXPECT_EQ(a[2], 0);
  EXPECT_DOUBLE_EQ(scaling->to_unit(samples().col(1))[0], 1);
}

TEST(Scaling, OfTheWholeMatrixUsesOneRange) {
  const auto scaling = Scaling::fit(samples().topRows(2), ScalingKind::whole_matrix);
  ASSERT_TRUE(scaling);
  EXPECT_EQ(scaling->minimum()[1], -0.12);
  EXPECT_EQ(scaling->maximum()[1], 0.1);
  // A radius spans only a tenth of the scale then.
  const double span = scaling->to_unit(samples().topRows(2).col(0))[1] -
                      scaling->to_unit(samples().topRows(2).col(1))[1];
  EXPECT_NEAR(span, 2 * 0.022 / 0.22, 1e-12);
}

// One multiplication and one addition each way: 1e-12 is a thousand ulp.
TEST(Scaling, ComesBackExactly) {
  Random random(5);
  for (const ScalingKind kind : {ScalingKind::each_feature, ScalingKind::whole_matrix}) {
    const auto scaling = Scaling::fit(samples(), kind, 0.1);
    ASSERT_TRUE(scaling);
    for (int trial = 0; trial < 100; ++trial) {
      const Eigen::Vector3d v(random.uniform(-1, 1), random.uniform(-1, 1), 7);
      EXPECT_TRUE(scaling->from_unit(scaling->to_unit(v)).isApprox(v, 1e-12));
    }
  }
}

TEST(Scaling, MarginLeavesRoomAtBothEnds) {
  const auto scaling = Scaling::fit(samples(), ScalingKind::each_feature, 0.1);
  ASSERT_TRUE(scaling);
  EXPECT_NEAR(scaling->to_unit(samples().col(0))[0], -1 / 1.2, 1e-12);
  EXPECT_NEAR(scaling->to_unit(samples().col(1))[0], 1 / 1.2, 1e-12);
}

TEST(Scaling, RefusesNonsense) {
  const Eigen::Vector2d low(0, 0), high(1, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(Scaling::create(low, high));
  EXPECT_FALSE(Scaling::create(Eigen::Vector2d(1, 1), low));
  EXPECT_FALSE(Scaling::create(low, Eigen::VectorXd::Zero(3)));
  EXPECT_FALSE(Scaling::fit(Eigen::MatrixXd(3, 0), ScalingKind::each_feature));
}

}  // namespace
}  // namespace prehend::learning
