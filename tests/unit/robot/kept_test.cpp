// For how long a joint was kept, of what was heard of it.
#include "services/robot/core/kept.hpp"

#include <gtest/gtest.h>

namespace prehend::robot {
namespace {

const Time begin = from_ns(5'000'000'000);

TEST(Kept, IsStalledThenStuckAndFreeAtOnceWhenItMoves) {
  Kept kept;
  double stalled_s = 0, stuck_s = 0;
  for (int n = 0; n < 200; ++n) {
    const double s = 0.01 * n;
    kept.observe(false, begin + seconds(s));
    if (stalled_s == 0 && kept.stalled()) stalled_s = s;
    if (stuck_s == 0 && kept.stuck()) stuck_s = s;
  }
  EXPECT_NEAR(stalled_s, 0.15, 0.02);
  EXPECT_NEAR(stuck_s, 1.2, 0.02);
  kept.observe(true, begin + seconds(3));
  EXPECT_FALSE(kept.stalled());
}

// On a busy machine a servo was said to be stuck 0.6 s after it was told where to go, half as long
// as that takes; time in which it was not heard had counted in full.
TEST(Kept, WhatIsNotHeardIsNotStuck) {
  Kept kept;
  kept.observe(true, begin);
  kept.observe(false, begin + seconds(2));
  EXPECT_FALSE(kept.stalled());
  kept.observe(false, begin + seconds(4));
  EXPECT_FALSE(kept.stuck());
}

}  // namespace
}  // namespace prehend::robot
