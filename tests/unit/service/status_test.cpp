// Health of a service: totals never shrink, rates are per second, quantiles are those of the
// window.
#include "common/service/status.hpp"

#include <gtest/gtest.h>

namespace prehend::service {
namespace {

TEST(Status, CountsRatesAndDrops) {
  Status status;
  v1::ServiceStatus message;
  status.count("frames", 10);
  status.fill(message, from_ns(0) + seconds(100));
  status.count("frames", 60);
  status.drop("not finite");
  status.drop("not finite", 2);
  status.fill(message, from_ns(0) + seconds(102));
  ASSERT_EQ(message.rates().size(), 1u);
  EXPECT_EQ(message.rates()[0].total(), 70u);
  EXPECT_DOUBLE_EQ(message.rates()[0].per_second(), 30);
  ASSERT_EQ(message.drops().size(), 1u);
  EXPECT_EQ(message.drops()[0].count(), 3u);
  EXPECT_EQ(status.dropped("not finite"), 3u);
  EXPECT_EQ(status.dropped("never"), 0u);
}

TEST(Status, ListsStayWithinTheMessageBounds) {
  Status status;
  for (int i = 0; i < 500; ++i) {
    status.count("rate" + std::to_string(i));
    status.drop("reason" + std::to_string(i) + std::string(100, 'x'));
    status.latency("stage" + std::to_string(i), seconds(1e-3));
  }
  v1::ServiceStatus message;
  status.degraded(std::string(1000, 'm'));
  status.fill(message, from_ns(1));
  EXPECT_LE(message.rates().size(), 64u);
  EXPECT_LE(message.drops().size(), 64u);
  EXPECT_LE(message.latency().size(), 32u);
  EXPECT_EQ(message.state(), v1::STATE_DEGRADED);
}

TEST(LatencyWindow, QuantilesOfTheLast1024) {
  LatencyWindow window;
  EXPECT_EQ(window.quantile_us(0.5), 0);
  for (int i = 0; i < 5000; ++i) window.add(seconds(1));  // old values that must be forgotten
  for (int i = 1; i <= 1024; ++i) window.add(seconds(i * 1e-6));
  EXPECT_EQ(window.count(), 1024u);
  EXPECT_NEAR(window.quantile_us(0.5), 512, 1);
  EXPECT_NEAR(window.quantile_us(0.99), 1014, 1);
  EXPECT_NEAR(window.max_us(), 1024, 1e-6);
}

}  // namespace
}  // namespace prehend::service
