// Scaling to [-1, 1] and back.
#include "common/learning/scaling.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/base/random.hpp"

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

// Eq. 4.11 to 4.16 to the letter. Lengths from -30 to 120 mm: m = 90, so -30 becomes
// (90 - (-30 + 30)) / 90 = 1, but 120 becomes (90 - 150) / 90 = -2/3, and on the way back
// m - (u - |min|) m differs from v by |min| (m + 1): 30 · 91 mm.
TEST(Scaling, AsPrintedDoesNotComeBack) {
  Eigen::MatrixXd mm(1, 2);
  mm << -30, 120;
  const auto scaling = Scaling::fit(mm, ScalingKind::as_printed);
  ASSERT_TRUE(scaling);
  const auto to_unit = [&](double v) { return scaling->to_unit(Eigen::VectorXd::Constant(1, v)); };
  EXPECT_NEAR(to_unit(-30)[0], 1, 1e-12);
  EXPECT_NEAR(to_unit(120)[0], -2.0 / 3, 1e-12);
  EXPECT_NEAR(scaling->from_unit(to_unit(50))[0] - 50, 30 * 91, 1e-9);
  EXPECT_FALSE(
      Scaling::create(Eigen::Vector2d(-1, -2), Eigen::Vector2d(1, 3), ScalingKind::as_printed))
      << "divides by max + min = 0";
}

// Where nothing is negative, only the range is wrong: [0, 1] for [-1, 1]; and it comes back.
TEST(Scaling, AsPrintedUsesHalfTheRangeOfPositiveNumbers) {
  Eigen::MatrixXd s(1, 3);
  s << 0, 0.4, 2;
  const auto scaling = Scaling::fit(s, ScalingKind::as_printed);
  ASSERT_TRUE(scaling);
  for (const double v : {0.0, 0.4, 1.1, 2.0}) {
    const Eigen::VectorXd u = scaling->to_unit(Eigen::VectorXd::Constant(1, v));
    EXPECT_NEAR(u[0], 1 - v / 2, 1e-12);
    EXPECT_NEAR(scaling->from_unit(u)[0], v, 1e-12);
  }
}

// Whether lengths are in m, cm or mm makes no difference as long as all rows are; 1e-12 for the
// factor 1000, which is no power of two.
TEST(Scaling, DoesNotDependOnTheUnit) {
  for (const ScalingKind kind : {ScalingKind::each_feature, ScalingKind::whole_matrix}) {
    const auto in_m = Scaling::fit(samples(), kind);
    const auto in_mm = Scaling::fit(1000 * samples(), kind);
    ASSERT_TRUE(in_m && in_mm);
    for (Eigen::Index k = 0; k < samples().cols(); ++k)
      EXPECT_TRUE(
          in_m->to_unit(samples().col(k)).isApprox(in_mm->to_unit(1000 * samples().col(k)), 1e-12));
  }
}

TEST(Scaling, IsKnownByName) {
  for (const auto kind :
       {ScalingKind::each_feature, ScalingKind::whole_matrix, ScalingKind::as_printed})
    EXPECT_EQ(scaling_from_string(to_string(kind)), kind);
  EXPECT_FALSE(scaling_from_string("none"));
}

TEST(Scaling, RefusesNonsense) {
  const Eigen::Vector2d low(0, 0), high(1, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(Scaling::create(low, high));
  EXPECT_FALSE(Scaling::create(Eigen::Vector2d(1, 1), low));
  EXPECT_FALSE(Scaling::create(low, Eigen::VectorXd::Zero(3)));
  EXPECT_FALSE(Scaling::fit(Eigen::MatrixXd(3, 0), ScalingKind::each_feature));
  EXPECT_EQ(Scaling::fit(high, ScalingKind::each_feature).error().what, "samples are not finite");
}

}  // namespace
}  // namespace prehend::learning
