// Two clocks with an offset and a drift exchange messages over a network with random delays, which
// may differ each way by any amount. What the filter must hold for every such pair:
//   |estimate - true offset| <= uncertainty, always. No tolerance: it is a bound, not a statistic;
//   the uncertainty is at most half the smallest delay of the last 16 exchanges plus the drift
//   since; a step larger than the uncertainties is found with the first exchange after it.
#include "common/clock/offset_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prehend::clock {
namespace {

using std::chrono::milliseconds;

/// Their clock: ours plus offset, running faster by `drift`. True time is ours.
struct Pair {
  Duration offset{};
  double drift = 0;
  Duration at(Time now) const {
    return offset + std::chrono::duration_cast<Duration>(drift * now.time_since_epoch());
  }
  Exchange exchange(Time begin, Duration there, Duration held, Duration back) const {
    const Time arrived = begin + there, answered = arrived + held, received = answered + back;
    return {begin, arrived + at(arrived), answered + at(answered), received};
  }
};

class AnyPair : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 random{GetParam()};
  double uniform(double a, double b) { return std::uniform_real_distribution(a, b)(random); }
  Pair pair() {
    return {seconds(std::pow(10, uniform(-5, 4)) * (uniform(0, 1) < 0.5 ? -1 : 1)),
            uniform(-1, 1) * OffsetFilter::drift};
  }
};

TEST_P(AnyPair, TheTruthIsWithinTheUncertainty) {
  const Pair clocks = pair();
  const double slow = std::pow(10, uniform(-4, -1));  // s, delays of this network
  OffsetFilter filter;
  Time now = from_ns(0);
  Duration smallest = Duration::max();
  for (int i = 0; i < 200; ++i) {
    const Duration there = seconds(slow * uniform(0, 1)), back = seconds(slow * uniform(0, 3));
    const Exchange exchange = clocks.exchange(now, there, seconds(uniform(0, 1)), back);
    ASSERT_TRUE(filter.add(exchange));
    now = exchange.received + seconds(uniform(0, 2));
    const auto known = filter.at(now);
    ASSERT_TRUE(known);
    const Duration error = known->offset - clocks.at(now);
    EXPECT_LE(std::chrono::abs(error), known->uncertainty);
    // No worse than what the last exchange alone tells.
    EXPECT_LE(to_seconds(known->uncertainty),
              0.5 * to_seconds(there + back) + 6 * OffsetFilter::drift + 1e-6);
    smallest = std::min(smallest, there + back);
  }
  EXPECT_EQ(filter.steps(), 0u) << "a drifting clock is not a stepping one";
  EXPECT_GE(filter.at(now)->uncertainty, smallest / 2 - milliseconds(1));
}

TEST_P(AnyPair, AStepIsFoundAtOnce) {
  Pair clocks = pair();
  OffsetFilter filter;
  Time now = from_ns(0);
  const auto run = [&](int rounds) {
    for (int i = 0; i < rounds; ++i) {
      const Exchange exchange = clocks.exchange(now, seconds(uniform(0, 0.01)), milliseconds(500),
                                                seconds(uniform(0, 0.01)));
      ASSERT_TRUE(filter.add(exchange));
      now = exchange.received;
    }
  };
  run(20);
  const Duration step = seconds(uniform(0, 1) < 0.5 ? 3600 : -3600);
  clocks.offset += step;
  run(1);
  EXPECT_EQ(filter.steps(), 1u);
  EXPECT_LE(std::chrono::abs(filter.at(now)->offset - clocks.at(now)), filter.at(now)->uncertainty);
}

INSTANTIATE_TEST_SUITE_P(Clocks, AnyPair, testing::Range(0u, 50u));

TEST(OffsetFilter, KnowsNothingBeforeTheFirstExchange) {
  EXPECT_FALSE(OffsetFilter().at(from_ns(0)));
}

TEST(OffsetFilter, ImpossibleStampsAreLeftOut) {
  const Pair clocks{seconds(5), 0};
  const Exchange good =
      clocks.exchange(from_ns(0), milliseconds(1), milliseconds(1), milliseconds(1));
  OffsetFilter filter;
  Exchange back_in_time = good;
  std::swap(back_in_time.sent, back_in_time.received);
  EXPECT_FALSE(filter.add(back_in_time));
  Exchange answered_before_it_came = good;
  std::swap(answered_before_it_came.arrived, answered_before_it_came.answered);
  EXPECT_FALSE(filter.add(answered_before_it_came));
  Exchange faster_than_nothing = good;
  faster_than_nothing.answered += seconds(1);
  EXPECT_FALSE(filter.add(faster_than_nothing));
  EXPECT_FALSE(filter.at(from_ns(0)));
}

// Regression guard: an asymmetric way (all of the delay one way) shifts the estimate by half the
// delay, which the uncertainty must own up to.
TEST(OffsetFilter, OwnsUpToAnAsymmetricWay) {
  const Pair clocks{seconds(-2), 0};
  OffsetFilter filter;
  ASSERT_TRUE(filter.add(clocks.exchange(from_ns(0), milliseconds(40), {}, {})));
  const Offset known = *filter.at(from_ns(0) + milliseconds(40));
  EXPECT_NEAR(to_seconds(known.offset), -2 + 0.02, 1e-5);
  EXPECT_GE(known.uncertainty, milliseconds(20));
  EXPECT_LT(known.uncertainty, milliseconds(21));
}

}  // namespace
}  // namespace prehend::clock
