// Who begins a handshake before it is admitted need not begin again, and a flood takes no memory.
#include "common/dds/guard/early_handshakes.hpp"

#include <gtest/gtest.h>

namespace prehend::dds {
namespace {

const Time first_heard = Time(std::chrono::hours(1));
const std::vector<std::uint8_t> one_message{1, 2, 3}, next_message{4, 5};

TEST(EarlyHandshakes, GiveTheLastMessageOnce) {
  EarlyHandshakes early;
  const GuidPrefix peer{0x81};
  EXPECT_FALSE(early.take(peer, first_heard));
  early.keep(peer, one_message, first_heard);
  early.keep(peer, next_message, first_heard);
  EXPECT_FALSE(early.take({0x82}, first_heard));
  EXPECT_EQ(early.take(peer, first_heard + seconds(1)), next_message);
  EXPECT_FALSE(early.take(peer, first_heard + seconds(1)));
  EXPECT_TRUE(early.empty());
}

TEST(EarlyHandshakes, AreForgottenInTimeAndInAFlood) {
  EarlyHandshakes early;
  early.keep({0x81}, one_message, first_heard);
  EXPECT_FALSE(early.take({0x81}, first_heard + seconds(3)));
  early.keep({0x81}, std::vector<std::uint8_t>(EarlyHandshakes::max_size + 1), first_heard);
  EXPECT_TRUE(early.empty());
  for (int i = 0; i < 1000; ++i)
    early.keep({0x80, static_cast<std::uint8_t>(i / 256), static_cast<std::uint8_t>(i % 256)},
               one_message, first_heard + std::chrono::milliseconds(i));
  EXPECT_FALSE(early.take({0x80, 0, 0}, first_heard + seconds(1)));
  EXPECT_TRUE(early.take({0x80, 999 / 256, 999 % 256}, first_heard + seconds(1)));
}

}  // namespace
}  // namespace prehend::dds
