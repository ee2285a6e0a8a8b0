// Intervals on cases that are known exactly, and that 95 % intervals hold the truth in
// 95 of 100 cases: with 4000 trials the share is within 1.1 points (three standard errors) of it.
#include "common/statistics/intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::statistics {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Tables of Student's distribution, to their last digit.
TEST(Student, IsAsInTables) {
  EXPECT_NEAR(student_95(1), 12.7062, 5e-5);
  EXPECT_NEAR(student_95(2), 4.30265, 5e-6);
  EXPECT_NEAR(student_95(3), 3.18245, 5e-6);
  EXPECT_NEAR(student_95(10), 2.22814, 5e-6);
  EXPECT_NEAR(student_95(23), 2.06866, 5e-6);
  EXPECT_NEAR(student_95(30), 2.04227, 5e-6);
  EXPECT_NEAR(student_95(1'000'000), 1.95996, 1e-5);
}

TEST(MeanInterval, OfThreeNumbers) {
  // Deviation 1, standard error 1/√3, two degrees of freedom.
  const Interval interval = mean_interval(std::vector{1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(interval.mean, 2);
  EXPECT_NEAR(interval.high - 2, 4.3026527 / std::sqrt(3), 1e-6);
  EXPECT_NEAR(2 - interval.low, 4.3026527 / std::sqrt(3), 1e-6);
  EXPECT_EQ(interval.count, 3u);
}

TEST(MeanInterval, LeavesOutWhatWasNotMeasured) {
  const Interval all = mean_interval(std::vector{1.0, 3.0, 2.0});
  const Interval some =
      mean_interval(std::vector{nan, 1.0, 3.0, std::numeric_limits<double>::infinity(), 2.0});
  EXPECT_EQ(some.mean, all.mean);
  EXPECT_EQ(some.low, all.low);
  EXPECT_EQ(some.count, 3u);
}

TEST(MeanInterval, KnowsNothingFromFewerThanTwo) {
  EXPECT_TRUE(std::isnan(mean_interval({}).mean));
  const Interval one = mean_interval(std::vector{5.0});
  EXPECT_EQ(one.mean, 5);
  EXPECT_TRUE(std::isinf(one.low) && std::isinf(one.high));
}

TEST(MeanInterval, HoldsTheTruthInNineteenOfTwentyCases) {
  Random random(3);
  for (const std::size_t n : {3u, 24u}) {
    int held = 0;
    constexpr int trials = 4000;
    for (int i = 0; i < trials; ++i) {
      std::vector<double> samples(n);
      for (double& x : samples) x = 7 + random.normal(2);
      const Interval interval = mean_interval(samples);
      held += interval.low < 7 && 7 < interval.high;
    }
    EXPECT_NEAR(held, 0.95 * trials, 0.011 * trials);
  }
}

TEST(PairedDifference, TakesOutWhatPairsShare) {
  // Pairs differ by 1 or 3 whatever they share.
  const std::vector<double> a{101, 203, 51, 4003}, b{100, 200, 50, 4000};
  const Interval difference = paired_difference(a, b);
  EXPECT_DOUBLE_EQ(difference.mean, 2);
  EXPECT_NEAR(difference.high - 2, 3.1824463 * std::sqrt(4.0 / 3) / 2, 1e-6);
  EXPECT_EQ(paired_difference(std::vector{1.0, nan, 2.0}, std::vector{1.0, 1.0, nan}).count, 1u);
}

TEST(GeometricMean, OfPowersOfTen) {
  const Interval interval = geometric_mean(std::vector{1e-6, 1e-2, 1e-4});
  EXPECT_NEAR(interval.mean, 1e-4, 1e-10);
  EXPECT_NEAR(interval.high / interval.mean, interval.mean / interval.low, 1e-6);
  // A ratio is the geometric mean of ratios: 2 and 8 give 4.
  EXPECT_NEAR(paired_ratio(std::vector{2.0, 800.0}, std::vector{1.0, 100.0}).mean, 4, 1e-12);
  EXPECT_EQ(paired_ratio(std::vector{2.0, nan, 8.0}, std::vector{1.0, 1.0, 1.0}).count, 2u);
}

// Wilson's interval: the textbook values for 0 and 5 of 10, and certainty nowhere.
TEST(ShareInterval, IsWilsons) {
  const Interval none = share_interval(0, 10), half = share_interval(5, 10);
  EXPECT_DOUBLE_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.27753, 5e-6);
  EXPECT_NEAR(half.low, 0.23659, 5e-6);
  EXPECT_NEAR(half.high, 0.76341, 5e-6);
  EXPECT_NEAR(share_interval(10, 10).low, 1 - none.high, 1e-12);
  EXPECT_EQ(share_interval(0, 0).low, 0);
  EXPECT_EQ(share_interval(0, 0).high, 1);
}

// Wilson's definition: the ends are the shares p for which the observed one lies 1.96 standard
// errors away. 1e-6: square roots of what was squared, near the ends of 0..1.
TEST(ShareInterval, EndsAreJustCompatibleWithWhatWasSeen) {
  for (const auto& [k, n] : {std::pair<std::size_t, std::size_t>{3, 10}, {50, 100}, {365, 367}}) {
    const Interval range = share_interval(k, n);
    const double seen = static_cast<double>(k) / static_cast<double>(n);
    EXPECT_EQ(range.mean, seen);
    for (const double p : {range.low, range.high})
      EXPECT_NEAR(std::abs(seen - p) / std::sqrt(p * (1 - p) / static_cast<double>(n)), 1.959964,
                  1e-6);
  }
}

TEST(Deviation, OfFourNumbers) {
  EXPECT_NEAR(deviation(std::vector{2.0, 4.0, 4.0, 6.0}), std::sqrt(8.0 / 3), 1e-12);
  EXPECT_EQ(deviation(std::vector{1.0}), 0);
}

TEST(DeviationRatio, FindsTheWiderOne) {
  Random random(4);
  std::vector<double> wide(200), narrow(200);
  for (double& x : wide) x = random.normal(3);
  for (double& x : narrow) x = random.normal(1);
  const Interval ratio = deviation_ratio(wide, narrow);
  EXPECT_LT(ratio.low, 3);
  EXPECT_GT(ratio.high, 3);
  EXPECT_GT(ratio.low, 2);
  EXPECT_DOUBLE_EQ(deviation_ratio(wide, wide).low, 1);
  EXPECT_EQ(deviation_ratio(wide, narrow).low, ratio.low) << "the same every time";
}

}  // namespace
}  // namespace prehend::statistics
