// A key that is held, as a terminal tells it: one character, a pause of up to 0.7 s, then one every
// 30 to 50 ms.
#include "common/tool/held_key.hpp"

#include <gtest/gtest.h>

namespace prehend::tool {
namespace {

using std::chrono::milliseconds;

const Time start = from_ns(1'700'000'000'000'000'000);

TEST(HeldKey, IsHeldWithItsRepeatsAndLetGoSoonAfterTheLast) {
  HeldKey key;
  EXPECT_FALSE(key.held(start));
  key.press(start);
  EXPECT_FALSE(key.held(start)) << "one press holds nothing";
  Time now = start + milliseconds(660);
  key.press(now);
  EXPECT_FALSE(key.held(now));
  for (int i = 0; i < 50; ++i) {
    now += milliseconds(40);
    key.press(now);
    EXPECT_TRUE(key.held(now + milliseconds(39)));
  }
  EXPECT_TRUE(key.held(now + milliseconds(120)));
  EXPECT_FALSE(key.held(now + milliseconds(121)));
}

TEST(HeldKey, IsNotHeldByPressesFarApart) {
  HeldKey key;
  for (int ms = 0; ms < 5000; ms += 130) {
    key.press(start + milliseconds(ms));
    EXPECT_FALSE(key.held(start + milliseconds(ms)));
  }
}

}  // namespace
}  // namespace prehend::tool
