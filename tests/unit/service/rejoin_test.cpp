// Revoked keys are heeded soon, but no hand is let go for them.
#include "common/service/rejoin.hpp"

#include <gtest/gtest.h>

namespace prehend::service {
namespace {

const Time start = Time(std::chrono::hours(1));

TEST(Rejoin, ComesAfterItsDelayAndNotBefore) {
  Rejoin rejoin;
  EXPECT_FALSE(rejoin.is_due(start, false));
  rejoin.ask(start, seconds(2));
  EXPECT_FALSE(rejoin.is_due(start + seconds(1.9), false));
  EXPECT_TRUE(rejoin.is_due(start + seconds(2), false));
  rejoin.ask(start + seconds(1), seconds(2));
  EXPECT_TRUE(rejoin.is_due(start + seconds(2), false)) << "a second list does not put it off";
}

TEST(Rejoin, WaitsForAHandButNotForEver) {
  Rejoin rejoin;
  rejoin.ask(start, seconds(2));
  EXPECT_FALSE(rejoin.is_due(start + seconds(30), true));
  EXPECT_TRUE(rejoin.is_due(start + seconds(30), false));
  EXPECT_TRUE(rejoin.is_due(start + seconds(62), true));
}

}  // namespace
}  // namespace prehend::service
