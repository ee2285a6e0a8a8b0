// What may pass is told by lengths alone: parts must lie within the message, and Fast DDS's
// statistics part must be the last and 56 bytes long, or its library ends the process by an
// assertion.
#include <gtest/gtest.h>

#include <prehend/dds/packet.hpp>
#include <random>
#include <vector>

namespace prehend::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes message() {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  bytes.resize(20);
  return bytes;
}

void add(Bytes& bytes, std::uint8_t kind, std::size_t length, bool little_endian = true) {
  const auto low = static_cast<std::uint8_t>(length & 255),
             high = static_cast<std::uint8_t>(length >> 8);
  bytes.insert(bytes.end(), {kind, static_cast<std::uint8_t>(little_endian),
                             little_endian ? low : high, little_endian ? high : low});
  bytes.resize(bytes.size() + length);
}

TEST(Packet, MessagesAsTheyAreSentPass) {
  Bytes bytes = message();
  EXPECT_TRUE(is_sound(bytes)) << "nothing but a header";
  add(bytes, 0x09, 8);
  add(bytes, 0x15, 300);
  add(bytes, 0x07, 28, false);
  EXPECT_TRUE(is_sound(bytes));
  add(bytes, 0x80, 56);
  EXPECT_TRUE(is_sound(bytes));
  Bytes open_end = message();
  add(open_end, 0x15, 100);
  open_end[22] = open_end[23] = 0;  // as long as the message
  EXPECT_TRUE(is_sound(open_end));
  Bytes invalid_time = message();
  add(invalid_time, 0x09, 0);
  add(invalid_time, 0x15, 20);
  EXPECT_TRUE(is_sound(invalid_time));
}

TEST(Packet, WhatIsCutOffDoesNot) {
  Bytes bytes = message();
  add(bytes, 0x09, 8);
  add(bytes, 0x15, 100);
  add(bytes, 0x80, 56);
  const Bytes whole = bytes;
  const std::vector<std::size_t> ends{20, 32, 136, 196};  // of the header and of each part
  for (std::size_t size = 0; size < whole.size(); ++size) {
    bytes.assign(whole.begin(), whole.begin() + static_cast<long>(size));
    EXPECT_EQ(is_sound(bytes), std::find(ends.begin(), ends.end(), size) != ends.end()) << size;
  }
}

// Regression guard: each of these ended every process of the lab that received it.
TEST(Packet, StatisticsThatAreNotTheLastPartDoNot) {
  Bytes not_last = message();
  add(not_last, 0x80, 56);
  add(not_last, 0x15, 20);
  EXPECT_FALSE(is_sound(not_last));
  Bytes too_long = message();
  add(too_long, 0x80, 64);
  EXPECT_FALSE(is_sound(too_long));
  Bytes bytes_behind = message();
  add(bytes_behind, 0x80, 56);
  bytes_behind.push_back(0xd4);
  EXPECT_FALSE(is_sound(bytes_behind));
  Bytes open_end = message();
  add(open_end, 0x80, 40);
  open_end[22] = open_end[23] = 0;
  EXPECT_FALSE(is_sound(open_end));
}

TEST(Packet, AnythingCanBeAsked) {
  std::mt19937 random{3};
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = message();
    bytes.resize(20 + random() % 200);
    for (std::size_t j = 20; j < bytes.size(); ++j) bytes[j] = static_cast<std::uint8_t>(random());
    is_sound(bytes);
  }
}

}  // namespace
}  // namespace prehend::dds
