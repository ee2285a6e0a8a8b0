// What may pass is told by lengths alone: parts must lie within the message, what is told at
// discovery must be lists of parameters, and Fast DDS's statistics part must be the last and 56
// bytes long, or its library ends the process by an assertion. And whose a message is: what it says
// of itself must agree in every place, in both orders of bytes.
#include "common/dds/guard/packet.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Bytes;
using test::Message;
using test::participant;

const GuidPrefix glove = participant(1), mapping = participant(2);

bool is_sound(const Bytes& bytes) {
  return read_packet(bytes).has_value();
}

std::optional<Packet> read(const Bytes& bytes) {
  return read_packet(bytes);
}

TEST(Packet, MessagesAsTheyAreSentPass) {
  Message message(glove);
  EXPECT_TRUE(is_sound(message)) << "nothing but a header";
  message.timestamp().sample(300).part(0x07, Bytes(28));
  EXPECT_TRUE(is_sound(message));
  EXPECT_TRUE(is_sound(message.part(0x80, Bytes(56))));
  Bytes open_end = Message(glove).part(0x06, Bytes(100));
  open_end[22] = open_end[23] = 0;  // as long as the message
  EXPECT_TRUE(is_sound(open_end));
  EXPECT_TRUE(is_sound(Message(glove).part(0x09, {}).sample())) << "a time stamp without a time";
}

TEST(Packet, WhatIsCutOffDoesNot) {
  const Bytes whole = Message(glove)
                          .timestamp()
                          .part(0x07, Bytes(28))
                          .announcement(glove, {})
                          .part(0x80, Bytes(56));
  std::vector<std::size_t> ends{20, 32, 64, whole.size() - 60, whole.size()};  // of each part
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes bytes(whole.begin(), whole.begin() + static_cast<long>(size));
    EXPECT_EQ(is_sound(bytes), std::find(ends.begin(), ends.end(), size) != ends.end()) << size;
  }
}

// Regression guard: each of these ended every process of the lab that received it.
TEST(Packet, StatisticsThatAreNotTheLastPartDoNot) {
  EXPECT_FALSE(is_sound(Message(glove).part(0x80, Bytes(56)).part(0x07, Bytes(28))));
  EXPECT_FALSE(is_sound(Message(glove).part(0x80, Bytes(64))));
  Bytes bytes_behind = Message(glove).part(0x80, Bytes(56));
  bytes_behind.push_back(0xd4);
  EXPECT_FALSE(is_sound(bytes_behind));
  Bytes open_end = Message(glove).part(0x80, Bytes(40));
  open_end[22] = open_end[23] = 0;
  EXPECT_FALSE(is_sound(open_end));
}

// Parts begin at multiples of four: what another reader takes for a part must not be hidden in
// what this one takes for padding.
TEST(Packet, PartsBeginAtMultiplesOfFour) {
  Bytes bytes = Message(glove).part(0x07, Bytes(30));
  bytes.resize(bytes.size() + 2);
  const Bytes source = Message(glove).source(mapping);
  bytes.insert(bytes.end(), source.begin() + 20, source.end());
  const auto packet = read_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->for_others);
}

TEST(Packet, AnAnnouncementSaysWhoWhereAndForHowLong) {
  for (const bool little_endian : {true, false}) {
    const auto packet = read_packet(
        Message(glove, little_endian)
            .timestamp()
            .announcement(glove, {{10, 0, 0, 1}, {192, 168, 1, 7}}, std::chrono::milliseconds(1500))
            .bytes());
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->sender, glove);
    EXPECT_FALSE(packet->for_others);
    ASSERT_EQ(packet->announcements.size(), 1u);
    const Announcement& said = packet->announcements[0];
    EXPECT_EQ(said.participant, glove);
    EXPECT_EQ(said.addresses, (std::vector<Ipv4>{{10, 0, 0, 1}, {192, 168, 1, 7}}));
    EXPECT_NEAR(to_seconds(said.lease), 1.5, 1e-6);
    EXPECT_FALSE(said.leaves);
    const auto end = read_packet(Message(glove, little_endian).departure(glove).bytes());
    ASSERT_TRUE(end);
    ASSERT_EQ(end->announcements.size(), 1u);
    EXPECT_TRUE(end->announcements[0].leaves);
    EXPECT_EQ(end->announcements[0].participant, glove);
  }
}

TEST(Packet, WhatIsSaidInAnothersNameIsSeenInEveryPlace) {
  for (const bool little_endian : {true, false}) {
    const auto others = [&](const Message& message) {
      const auto packet = read_packet(message.bytes());
      EXPECT_TRUE(packet);
      return packet && packet->for_others;
    };
    const auto from_glove = [&] { return Message(glove, little_endian); };
    EXPECT_FALSE(others(from_glove().source(glove).endpoint(glove).liveliness(glove).sample()));
    EXPECT_TRUE(others(from_glove().source(mapping).sample()));
    EXPECT_TRUE(others(from_glove().endpoint(mapping)));
    EXPECT_TRUE(others(from_glove().liveliness(mapping)));
    EXPECT_TRUE(others(from_glove().announcement(mapping, {})));
    EXPECT_TRUE(others(from_glove().departure(mapping)));
    EXPECT_TRUE(others(from_glove().announcement(glove, {}).endpoint(mapping)));
  }
}

TEST(Packet, AnythingCanBeAsked) {
  std::mt19937 random{3};
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = Message(glove);
    bytes.resize(20 + random() % 200);
    for (std::size_t j = 20; j < bytes.size(); ++j) bytes[j] = static_cast<std::uint8_t>(random());
    is_sound(bytes);
  }
}

// Fast DDS 3 does not hand these on before a handshake has ended well.
TEST(Packet, AnAnnouncementTellsWhoSpeaksWithWhatKeysAndWhatMiddleware) {
  for (const bool little_endian : {true, false}) {
    Message message(glove, little_endian);
    message.announcement(glove, {}, std::chrono::seconds(20),
                         {{0x0062, message.text("the\nglove")},
                          {0x1001, message.token("/CN=lab")},
                          {0x8000, {3, 1, 2, 0}}});
    const auto packet = read(message);
    ASSERT_TRUE(packet && packet->announcements.size() == 1);
    const Announcement& said = packet->announcements.front();
    EXPECT_EQ(said.name, "theglove");
    EXPECT_TRUE(said.secured);
    EXPECT_EQ(said.authority, "/CN=lab");
    EXPECT_EQ(said.certificate, "/CN=somebody");
    EXPECT_EQ(said.middleware, "Fast DDS 3.1.2");
  }
  Message open(mapping);
  open.announcement(
      mapping, {}, std::chrono::seconds(20),
      {{0x002c, open.text("Fast DDS 2.9.1; mapping")}, {0x0062, open.text("mapping")}});
  const Announcement said = read(open)->announcements.front();
  EXPECT_EQ(said.middleware, "Fast DDS 2.9.1");
  EXPECT_EQ(said.role, Role::mapping);
  EXPECT_FALSE(said.secured);
}

TEST(Packet, WhatAnAnnouncementTellsMayBeDamaged) {
  Message whole(glove);
  const Bytes token = whole.token("/CN=lab"), name = whole.text("glove");
  for (std::size_t size = 0; size <= token.size(); size += 4) {
    Bytes cut(token.begin(), token.begin() + static_cast<long>(size));
    EXPECT_TRUE(
        read(Message(glove).announcement(glove, {}, std::chrono::seconds(1), {{0x1001, cut}})));
    for (std::size_t at = 0; at + 4 <= cut.size(); at += 4) {
      Bytes lies = cut;
      std::fill_n(lies.begin() + static_cast<long>(at), 4, std::uint8_t{255});
      EXPECT_TRUE(
          read(Message(glove).announcement(glove, {}, std::chrono::seconds(1), {{0x1001, lies}})));
    }
  }
  EXPECT_TRUE(read(Message(glove).announcement(glove, {}, std::chrono::seconds(1),
                                               {{0x0062, {255, 255, 255, 255}}})));
}

}  // namespace
}  // namespace prehend::dds
