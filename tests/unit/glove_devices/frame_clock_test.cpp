// The clock that stamps frames. A device measures every P seconds by its own clock, which differs
// from ours by up to 1e-4; frame n arrives d_n >= 0 later. What the stamps shall be is the
// measurement's time plus a constant, so each test compares the deviation of (stamp - measurement)
// with that of (arrival - measurement).
#include "services/glove/devices/frame_clock.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::glove {
namespace {

const Time begin(std::chrono::hours(480000));

struct Errors {
  double arrival = 0, stamp = 0;  // s, standard deviations
};

double deviation(const std::vector<double>& x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  double sum = 0;
  for (const double v : x) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

/// Feeds frames and checks what holds always: strictly increasing stamps close to the arrival.
template <class Delay>
Errors run(double rate, int frames, double lost, std::uint64_t seed, Delay delay) {
  Random random(seed);
  FrameClock clock;
  std::vector<double> arrivals, stamps;
  Time last_stamp{}, last_arrival = begin;
  for (int n = 0; n < frames; ++n) {
    const double measured = n / rate * (1 + 1e-4);
    const double late = delay(random, n);
    if (random.uniform() < lost) continue;
    // A line keeps the order.
    const Time arrival = std::max(last_arrival, begin + seconds(measured + late));
    last_arrival = arrival;
    const Time stamp = clock.stamp(arrival);
    EXPECT_GT(stamp, last_stamp);
    EXPECT_LE(stamp, std::max(arrival, last_stamp + Duration(1)));
    EXPECT_GE(to_seconds(stamp - arrival), -FrameClock::slack);
    last_stamp = stamp;
    if (n < frames / 4) continue;  // settled by then
    arrivals.push_back(to_seconds(arrival - begin) - measured);
    stamps.push_back(to_seconds(stamp - begin) - measured);
  }
  EXPECT_NEAR(clock.period() * rate, 1, 0.02);
  return {deviation(arrivals), deviation(stamps)};
}

// Exponential delays, as queues have; a tracker of 30 Hz, of 100 Hz, a glove of 150 Hz.
TEST(FrameClock, TakesOutJitter) {
  for (const double rate : {30.0, 100.0, 150.0})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Errors errors = run(rate, 4000, 0, seed, [](Random& random, int) {
        return -0.003 * std::log(1 - random.uniform());
      });
      EXPECT_LT(errors.stamp, errors.arrival / 2) << rate;
    }
}

// A USB adapter hands over what it has every 16 ms.
TEST(FrameClock, TakesOutTheLatencyTimerOfAnAdapter) {
  const Errors errors = run(100, 4000, 0, 1, [](Random&, int n) {
    const double measured = n / 100.0 * (1 + 1e-4);
    return std::ceil(measured / 0.016) * 0.016 - measured;
  });
  EXPECT_LT(errors.stamp, errors.arrival / 2);
}

// The machine stands still for 80 ms now and then: eight frames come at once.
TEST(FrameClock, SpreadsABurst) {
  const Errors errors = run(100, 4000, 0, 1, [](Random& random, int n) {
    const int in = n % 200;
    return (in < 8 ? (8 - in) * 0.01 : 0.0) + 0.0005 * random.uniform();
  });
  EXPECT_LT(errors.stamp, errors.arrival / 5);
}

// A frame that is lost makes the clock late by a period until the next correction, 8 frames later.
TEST(FrameClock, FollowsLostFrames) {
  const Errors errors =
      run(100, 8000, 0.01, 3, [](Random& random, int) { return 0.001 * random.uniform(); });
  EXPECT_LT(errors.stamp, 0.004);
}

TEST(FrameClock, BeginsAnewAfterAPause) {
  FrameClock clock;
  Time arrival = begin;
  for (int n = 0; n < 50; ++n) clock.stamp(arrival += std::chrono::milliseconds(10));
  EXPECT_NEAR(clock.period(), 0.01, 1e-9);
  arrival += std::chrono::seconds(3);
  EXPECT_EQ(clock.stamp(arrival), arrival);
  for (int n = 0; n < 50; ++n) clock.stamp(arrival += std::chrono::milliseconds(33));
  EXPECT_NEAR(clock.period(), 0.033, 1e-6);
}

// Somebody sets the device to another rate while it runs.
TEST(FrameClock, LearnsAnotherRate) {
  for (const int period : {5, 8, 12, 20}) {
    FrameClock clock;
    Time arrival = begin;
    for (int n = 0; n < 100; ++n) clock.stamp(arrival += std::chrono::milliseconds(10));
    for (int n = 0; n < 1000; ++n) clock.stamp(arrival += std::chrono::milliseconds(period));
    EXPECT_NEAR(clock.period(), 0.001 * period, 1e-5);
  }
}

}  // namespace
}  // namespace prehend::glove
