// Who may speak for a participant: only packets from where it announced itself and from where it
// said it would be. Times and addresses are told, so the same packets have the same fate each time.
#include "common/dds/guard/address_book.hpp"

#include <gtest/gtest.h>

#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Message;
using test::participant;

const GuidPrefix glove_prefix = participant(1), mapping_prefix = participant(2),
                 stranger = participant(66);
constexpr Ipv4 at_glove{10, 0, 0, 1}, at_mapping{10, 0, 0, 2}, at_stranger{10, 0, 0, 66},
    other_net{192, 168, 1, 1}, here{127, 0, 0, 1};
constexpr Time start = Time(std::chrono::hours(1));

class Book : public testing::Test {
 protected:
  PacketVerdict judge(const Message& message, std::optional<Ipv4> source, double s = 0) {
    return book_.judge(message.bytes(), source, start + seconds(s));
  }
  AddressBook book_;
};

TEST_F(Book, OnlyWhoWasAnnouncedSpeaksAndOnlyFromItsAddresses) {
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove), PacketVerdict::unannounced);
  EXPECT_EQ(judge(Message(glove_prefix).announcement(glove_prefix, {other_net}), at_glove),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), other_net), PacketVerdict::pass)
      << "a second network";
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_stranger), PacketVerdict::elsewhere);
  EXPECT_EQ(judge(Message(glove_prefix).announcement(glove_prefix, {at_stranger}), at_stranger),
            PacketVerdict::elsewhere);
  EXPECT_EQ(judge(Message(glove_prefix).departure(glove_prefix), at_stranger),
            PacketVerdict::elsewhere);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_stranger), PacketVerdict::elsewhere);
  // An address that it gets later, told from one that it has.
  EXPECT_EQ(judge(Message(glove_prefix).announcement(glove_prefix, {{10, 9, 9, 9}}), at_glove),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), Ipv4{10, 9, 9, 9}), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).departure(mapping_prefix), at_glove),
            PacketVerdict::in_other_name);
}

// Regression guard: one such packet told an endpoint away from its peers until all was restarted.
TEST_F(Book, AMemberDoesNotSpeakForOthers) {
  judge(Message(glove_prefix).announcement(glove_prefix, {}), at_glove);
  judge(Message(stranger).announcement(stranger, {}), at_stranger);
  EXPECT_EQ(judge(Message(stranger).endpoint(glove_prefix), at_stranger),
            PacketVerdict::in_other_name);
  EXPECT_EQ(judge(Message(stranger).source(glove_prefix).sample(), at_stranger),
            PacketVerdict::in_other_name);
  EXPECT_EQ(judge(Message(stranger).announcement(glove_prefix, {}), at_stranger),
            PacketVerdict::in_other_name);
  EXPECT_EQ(judge(Message(participant(9)).announcement(glove_prefix, {}), at_stranger),
            PacketVerdict::in_other_name);
  EXPECT_EQ(book_.size(), 2u);
}

TEST_F(Book, AfterItsLeaseASilentParticipantMayAppearElsewhere) {
  const Message announcement = Message(glove_prefix).announcement(glove_prefix, {}, seconds(20));
  EXPECT_EQ(judge(announcement, at_glove, 0), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove, 15), PacketVerdict::pass);
  EXPECT_EQ(judge(announcement, other_net, 34), PacketVerdict::elsewhere) << "it spoke 19 s ago";
  EXPECT_EQ(judge(Message(glove_prefix).sample(), other_net, 36), PacketVerdict::elsewhere)
      << "only an announcement moves it";
  EXPECT_EQ(judge(announcement, other_net, 36), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), other_net, 36), PacketVerdict::pass);
  // Silence alone takes nothing away: a server announces its clients once.
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove, 5000), PacketVerdict::pass);
  // Who has left may come back from anywhere at once.
  EXPECT_EQ(judge(Message(glove_prefix).departure(glove_prefix), at_glove, 5001),
            PacketVerdict::pass);
  EXPECT_EQ(judge(announcement, at_mapping, 5001.1), PacketVerdict::pass);
  // What is of no use any more is forgotten.
  judge(Message(glove_prefix).departure(glove_prefix), at_mapping, 5002);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_mapping, 5003), PacketVerdict::pass)
      << "still on its way";
  judge(Message(mapping_prefix).announcement(mapping_prefix, {}), at_mapping, 5020);
  EXPECT_EQ(book_.size(), 1u);
}

TEST_F(Book, ThisHostsOwnProgramsAreNotToldApartButNobodyElseIsOneOfThem) {
  judge(Message(glove_prefix).announcement(glove_prefix, {}), here);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), Ipv4{127, 0, 1, 1}), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_stranger), PacketVerdict::elsewhere);
  book_.add_own(mapping_prefix);
  EXPECT_EQ(judge(Message(mapping_prefix).announcement(mapping_prefix, {}), here),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(mapping_prefix).announcement(mapping_prefix, {}), at_stranger, 1e6),
            PacketVerdict::elsewhere);
}

TEST_F(Book, WithoutASourceOnlyNamesCount) {
  EXPECT_EQ(judge(Message(glove_prefix).sample(), std::nullopt), PacketVerdict::unannounced);
  EXPECT_EQ(judge(Message(glove_prefix).announcement(glove_prefix, {at_glove}), std::nullopt),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), std::nullopt), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).endpoint(mapping_prefix), std::nullopt),
            PacketVerdict::in_other_name);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_stranger), PacketVerdict::elsewhere);
}

TEST_F(Book, OnlyADiscoveryServerTellsOfOthers) {
  GuidPrefix second_server = first_server;
  second_server[2] = 1;
  book_.add_server(first_server, other_net);
  EXPECT_EQ(judge(Message(first_server).announcement(first_server, {}), other_net),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(first_server).announcement(glove_prefix, {at_glove}), at_stranger),
            PacketVerdict::elsewhere);
  EXPECT_EQ(
      judge(Message(first_server).announcement(glove_prefix, {at_glove}).endpoint(glove_prefix),
            other_net),
      PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove), PacketVerdict::pass);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), other_net), PacketVerdict::elsewhere);
  EXPECT_EQ(judge(Message(second_server).announcement(second_server, {}), at_stranger),
            PacketVerdict::pass);
  EXPECT_EQ(judge(Message(second_server).announcement(mapping_prefix, {}), at_stranger),
            PacketVerdict::in_other_name)
      << "nobody named this server";
  // Who is a server itself hears of the clients of servers that are linked to it.
  AddressBook server(true);
  const auto tell = [&](const Message& message) {
    return server.judge(message.bytes(), at_stranger, start);
  };
  EXPECT_EQ(tell(Message(second_server).announcement(second_server, {})), PacketVerdict::pass);
  EXPECT_EQ(tell(Message(second_server).announcement(mapping_prefix, {})), PacketVerdict::pass);
  EXPECT_EQ(tell(Message(stranger).announcement(stranger, {})), PacketVerdict::pass);
  EXPECT_EQ(tell(Message(stranger).announcement(glove_prefix, {})), PacketVerdict::in_other_name);
}

TEST_F(Book, IsBoundedAndOneHostDoesNotCrowdOutTheOthers) {
  const auto number = [](std::size_t n) {
    GuidPrefix prefix = participant(100);
    prefix[4] = static_cast<std::uint8_t>(n >> 8);
    prefix[5] = static_cast<std::uint8_t>(n);
    return prefix;
  };
  judge(Message(glove_prefix).announcement(glove_prefix, {}, seconds(20)), at_glove);
  std::size_t passed = 0;
  for (std::size_t n = 0; n < 3 * AddressBook::max_of_one; ++n)
    passed += judge(Message(number(n)).announcement(number(n), {}, seconds(20)), at_stranger) ==
              PacketVerdict::pass;
  EXPECT_EQ(passed, AddressBook::max_of_one);
  EXPECT_EQ(
      judge(Message(mapping_prefix).announcement(mapping_prefix, {}, seconds(20)), at_mapping),
      PacketVerdict::pass);
  for (std::size_t n = 0; n < 2 * AddressBook::max_participants; ++n) {
    const Ipv4 from{10, 1, static_cast<std::uint8_t>(n >> 8), static_cast<std::uint8_t>(n)};
    judge(Message(number(10'000 + n)).announcement(number(10'000 + n), {}, seconds(20)), from);
  }
  EXPECT_EQ(book_.size(), AddressBook::max_participants);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove, 10), PacketVerdict::pass);
  // All but the glove_prefix have been silent for longer than their lease: there is room again.
  EXPECT_EQ(judge(Message(stranger).announcement(stranger, {}), at_stranger, 25),
            PacketVerdict::pass);
  EXPECT_EQ(book_.size(), 2u);
  EXPECT_EQ(judge(Message(glove_prefix).sample(), at_glove, 26), PacketVerdict::pass);
  for (int n = 0; n < 100; ++n)
    judge(Message(glove_prefix)
              .announcement(glove_prefix, {{10, 2, 0, static_cast<std::uint8_t>(n)}}),
          at_glove, 27);
  int from = 0;
  for (int n = 0; n < 100; ++n)
    from += judge(Message(glove_prefix).sample(), Ipv4{10, 2, 0, static_cast<std::uint8_t>(n)},
                  28) == PacketVerdict::pass;
  EXPECT_LT(from, static_cast<int>(AddressBook::max_addresses));
}

}  // namespace
}  // namespace prehend::dds
