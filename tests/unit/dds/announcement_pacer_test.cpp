// Who is told of a participant, and how often: newcomers at once, everybody often enough for a
// lease, and nobody N times when N others come. Times are told.
#include "common/dds/guard/announcement_pacer.hpp"

#include <gtest/gtest.h>

#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Message;

class AnnouncementPacerTest : public testing::Test {
 protected:
  static constexpr Place peer{{10, 0, 0, 2}, 7410}, group{{239, 255, 0, 1}, 7400};
  bool due(const Place& to, double s, std::uint64_t number = 1, int way = 0) {
    return pacer_.is_due(to, &sockets_[way], {0x000100c2, false, number}, at(s));
  }
  static Time at(double s) { return Time(std::chrono::hours(1)) + seconds(s); }
  int sockets_[2] = {};
  AnnouncementPacer pacer_;
};

TEST_F(AnnouncementPacerTest, APeerHearsTheSameLessAndLessOftenButFourTimesInALease) {
  std::vector<double> sent;
  for (int i = 0; i < 60'000; ++i)
    if (due(peer, 1e-3 * i)) sent.push_back(1e-3 * i);
  ASSERT_GE(sent.size(), 12u);
  EXPECT_EQ(sent.front(), 0);
  EXPECT_NEAR(sent[1], 0.5, 2e-3);
  for (std::size_t i = 1; i < sent.size(); ++i) EXPECT_LE(sent[i] - sent[i - 1], 5.001);
  EXPECT_LT(sent.size(), 20u) << "every half second it would be 120";
}

TEST_F(AnnouncementPacerTest, WhatChangedAndWhoIsNewIsToldAtOnce) {
  pacer_.met(peer, test::participant(1));
  EXPECT_TRUE(due(peer, 0));
  EXPECT_FALSE(due(peer, 0.1));
  EXPECT_TRUE(due(peer, 0.1, 2)) << "another announcement";
  EXPECT_TRUE(due(peer, 0.1, 2, 1)) << "through another socket";
  pacer_.met(peer, test::participant(1));
  EXPECT_FALSE(due(peer, 0.15, 2));
  pacer_.met(peer, test::participant(2));  // a process that was started again has the same port
  EXPECT_TRUE(due(peer, 0.15, 2));
  EXPECT_FALSE(due(peer, 0.16, 2));
  EXPECT_TRUE(due({{10, 0, 0, 2}, 7412}, 0.16, 2)) << "its neighbour";
}

TEST_F(AnnouncementPacerTest, TheGroupHearsAllButThoseOnTheHeelsOfAnother) {
  int sent = 0;
  for (int i = 0; i < 10'000; ++i) sent += due(group, 1e-3 * i);
  EXPECT_EQ(sent, 200);
  for (double s = 20; s < 30; s += 0.1) EXPECT_TRUE(due(group, s));
}

TEST_F(AnnouncementPacerTest, EachWriterIsAskedForItself) {
  const auto ask = [&](std::uint32_t writer, double s) {
    return pacer_.is_due(peer, &sockets_[0], {writer, true, 0}, at(s));
  };
  EXPECT_TRUE(due(peer, 0));
  EXPECT_TRUE(ask(0x000003c2, 0));
  EXPECT_TRUE(ask(0x000004c2, 0));
  EXPECT_FALSE(ask(0x000003c2, 0.07));
  EXPECT_TRUE(ask(0x000003c2, 0.51));
}

TEST_F(AnnouncementPacerTest, ItIsBounded) {
  for (int i = 0; i < 100'000; ++i)
    due({{10, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)},
         static_cast<std::uint16_t>(i >> 16)},
        0);
  EXPECT_LE(pacer_.size(), AnnouncementPacer::max_places);
}

TEST(AnnouncedPlaces, AreThoseOfDiscovery) {
  const GuidPrefix self = test::participant(1);
  for (const bool little_endian : {true, false}) {
    const Message in(self, little_endian);
    const Message said = Message(in).timestamp().announcement(
        self, {{10, 0, 0, 1}}, std::chrono::seconds(20),
        {{0x0032, in.locator({192, 168, 1, 7})}, {0x0032, test::Bytes(8)}});
    EXPECT_EQ(announced_places(said.bytes()), (std::vector<Place>{{{192, 168, 1, 7}, 7411}}));
    EXPECT_TRUE(announced_places(Message(in).departure(self).bytes()).empty());
    EXPECT_TRUE(announced_places(Message(in).sample().bytes()).empty());
  }
}

TEST(RepeatedSaying, IsAnAnnouncementOrAQuestionAlone) {
  const GuidPrefix self = test::participant(1);
  for (const bool little_endian : {true, false}) {
    const Message in(self, little_endian);
    const auto number = [](const Message& message) -> std::optional<std::uint64_t> {
      const auto said = repeated_saying(message.bytes());
      return said && !said->asks ? std::optional(said->number) : std::nullopt;
    };
    EXPECT_EQ(number(Message(in).timestamp().announcement(self, {{10, 0, 0, 1}})), 1u);
    EXPECT_EQ(number(Message(in).part(0x0e, test::Bytes(12)).data({.sequence = 7})), 7u);
    EXPECT_EQ(number(Message(in).data({.sequence = 7}).part(0x80, test::Bytes(56))), 7u);
    const auto says = [](const Message& message) {
      return repeated_saying(message.bytes()).has_value();
    };
    EXPECT_FALSE(says(Message(in).departure(self))) << "it must arrive";
    EXPECT_FALSE(says(Message(in).announcement(self, {}).sample()));
    EXPECT_FALSE(says(Message(in).announcement(self, {}).announcement(self, {})));
    EXPECT_FALSE(says(Message(in).endpoint(self)));
    EXPECT_FALSE(says(Message(in).sample()));
    EXPECT_FALSE(says(in));

    test::Bytes question(24);  // reader, writer, where it begins, how many, a count
    question[6] = 0x03, question[7] = 0xc2;
    const auto asked = repeated_saying(Message(in).part(0x06, question).bytes());
    ASSERT_TRUE(asked && asked->asks);
    EXPECT_EQ(asked->writer, 0x000003c2u);
    EXPECT_FALSE(says(Message(in).part(0x06, question, 0x02))) << "an answer";
    for (const std::size_t byte : {std::size_t{12}, std::size_t{15}, std::size_t{16}}) {
      test::Bytes more = question;
      more[byte] = 1;
      EXPECT_FALSE(says(Message(in).part(0x06, more))) << "it knows something";
    }
  }
}

}  // namespace
}  // namespace prehend::dds
