// When a hand is told to stay: not before the first answer, then after the timeout, and no more
// often than the period. All numbers are whole nanoseconds, so nothing needs a tolerance.
#include "services/mapping/core/hold_timer.hpp"

#include <gtest/gtest.h>

namespace prehend::mapping {
namespace {

using std::chrono::milliseconds;

TEST(HoldTimer, IsDueAfterTheTimeoutAndNoMoreOftenThanThePeriod) {
  HoldTimer timer({.posture_timeout = milliseconds(60), .period = milliseconds(10)});
  const auto at = [](int ms) { return Time(milliseconds(ms)); };
  EXPECT_FALSE(timer.due(at(5000))) << "nothing has been answered yet";
  timer.answered(at(0));
  EXPECT_FALSE(timer.due(at(59)));
  EXPECT_TRUE(timer.due(at(60)));
  EXPECT_FALSE(timer.due(at(60))) << "at the same time again";
  EXPECT_FALSE(timer.due(at(69)));
  EXPECT_TRUE(timer.due(at(70)));
  timer.answered(at(75));
  EXPECT_FALSE(timer.due(at(134)));
  EXPECT_TRUE(timer.due(at(135)));
}

}  // namespace
}  // namespace prehend::mapping
