// Who may speak for a participant: only packets from where it announced itself and from where it
// said it would be. Times and addresses are told, so the same packets have the same fate each time.
#include <gtest/gtest.h>

#include <prehend/dds/address_book.hpp>
#include <prehend/test_packets/packets.hpp>

namespace prehend::dds {
namespace {

using test::Message;
using test::participant;

const GuidPrefix glove = participant(1), mapping = participant(2), stranger = participant(66);
constexpr Ipv4 at_glove{10, 0, 0, 1}, at_mapping{10, 0, 0, 2}, at_stranger{10, 0, 0, 66},
    other_net{192, 168, 1, 1}, here{127, 0, 0, 1};
constexpr Time start = Time(std::chrono::hours(1));

class Book : public testing::Test {
 protected:
  Verdict judge(const Message& message, std::optional<Ipv4> source, double s = 0) {
    return book_.judge(message.bytes(), source, start + seconds(s));
  }
  AddressBook book_;
};

TEST_F(Book, OnlyWhoWasAnnouncedSpeaksAndOnlyFromItsAddresses) {
  EXPECT_EQ(judge(Message(glove).sample(), at_glove), Verdict::unannounced);
  EXPECT_EQ(judge(Message(glove).announcement(glove, {other_net}), at_glove), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), other_net), Verdict::pass) << "a second network";
  EXPECT_EQ(judge(Message(glove).sample(), at_stranger), Verdict::elsewhere);
  EXPECT_EQ(judge(Message(glove).announcement(glove, {at_stranger}), at_stranger),
            Verdict::elsewhere);
  EXPECT_EQ(judge(Message(glove).departure(glove), at_stranger), Verdict::elsewhere);
  EXPECT_EQ(judge(Message(glove).sample(), at_stranger), Verdict::elsewhere);
  // An address that it gets later, told from one that it has.
  EXPECT_EQ(judge(Message(glove).announcement(glove, {{10, 9, 9, 9}}), at_glove), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), Ipv4{10, 9, 9, 9}), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).departure(mapping), at_glove), Verdict::in_other_name);
}

// Regression guard: one such packet told an endpoint away from its peers until all was restarted.
TEST_F(Book, AMemberDoesNotSpeakForOthers) {
  judge(Message(glove).announcement(glove, {}), at_glove);
  judge(Message(stranger).announcement(stranger, {}), at_stranger);
  EXPECT_EQ(judge(Message(stranger).endpoint(glove), at_stranger), Verdict::in_other_name);
  EXPECT_EQ(judge(Message(stranger).source(glove).sample(), at_stranger), Verdict::in_other_name);
  EXPECT_EQ(judge(Message(stranger).announcement(glove, {}), at_stranger), Verdict::in_other_name);
  EXPECT_EQ(judge(Message(participant(9)).announcement(glove, {}), at_stranger),
            Verdict::in_other_name);
  EXPECT_EQ(book_.size(), 2u);
}

TEST_F(Book, AfterItsLeaseASilentParticipantMayAppearElsewhere) {
  const Message announcement = Message(glove).announcement(glove, {}, seconds(20));
  EXPECT_EQ(judge(announcement, at_glove, 0), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove, 15), Verdict::pass);
  EXPECT_EQ(judge(announcement, other_net, 34), Verdict::elsewhere) << "it spoke 19 s ago";
  EXPECT_EQ(judge(Message(glove).sample(), other_net, 36), Verdict::elsewhere)
      << "only an announcement moves it";
  EXPECT_EQ(judge(announcement, other_net, 36), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), other_net, 36), Verdict::pass);
  // Silence alone takes nothing away: a server announces its clients once.
  EXPECT_EQ(judge(Message(glove).sample(), at_glove, 5000), Verdict::pass);
  // Who has left may come back from anywhere at once.
  EXPECT_EQ(judge(Message(glove).departure(glove), at_glove, 5001), Verdict::pass);
  EXPECT_EQ(judge(announcement, at_mapping, 5001.1), Verdict::pass);
  // What is of no use any more is forgotten.
  judge(Message(glove).departure(glove), at_mapping, 5002);
  EXPECT_EQ(judge(Message(glove).sample(), at_mapping, 5003), Verdict::pass) << "still on its way";
  judge(Message(mapping).announcement(mapping, {}), at_mapping, 5020);
  EXPECT_EQ(book_.size(), 1u);
}

TEST_F(Book, ThisHostsOwnProgramsAreNotToldApartButNobodyElseIsOneOfThem) {
  judge(Message(glove).announcement(glove, {}), here);
  EXPECT_EQ(judge(Message(glove).sample(), Ipv4{127, 0, 1, 1}), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), at_stranger), Verdict::elsewhere);
  book_.add_own(mapping);
  EXPECT_EQ(judge(Message(mapping).announcement(mapping, {}), here), Verdict::pass);
  EXPECT_EQ(judge(Message(mapping).announcement(mapping, {}), at_stranger, 1e6),
            Verdict::elsewhere);
}

TEST_F(Book, WithoutASourceOnlyNamesCount) {
  EXPECT_EQ(judge(Message(glove).sample(), std::nullopt), Verdict::unannounced);
  EXPECT_EQ(judge(Message(glove).announcement(glove, {at_glove}), std::nullopt), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), std::nullopt), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).endpoint(mapping), std::nullopt), Verdict::in_other_name);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), at_stranger), Verdict::elsewhere);
}

TEST_F(Book, OnlyADiscoveryServerTellsOfOthers) {
  GuidPrefix second_server = first_server;
  second_server[2] = 1;
  book_.add_server(first_server, other_net);
  EXPECT_EQ(judge(Message(first_server).announcement(first_server, {}), other_net), Verdict::pass);
  EXPECT_EQ(judge(Message(first_server).announcement(glove, {at_glove}), at_stranger),
            Verdict::elsewhere);
  EXPECT_EQ(judge(Message(first_server).announcement(glove, {at_glove}).endpoint(glove), other_net),
            Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove), Verdict::pass);
  EXPECT_EQ(judge(Message(glove).sample(), other_net), Verdict::elsewhere);
  EXPECT_EQ(judge(Message(second_server).announcement(second_server, {}), at_stranger),
            Verdict::pass);
  EXPECT_EQ(judge(Message(second_server).announcement(mapping, {}), at_stranger),
            Verdict::in_other_name)
      << "nobody named this server";
  // Who is a server itself hears of the clients of servers that are linked to it.
  AddressBook server(true);
  const auto tell = [&](const Message& message) {
    return server.judge(message.bytes(), at_stranger, start);
  };
  EXPECT_EQ(tell(Message(second_server).announcement(second_server, {})), Verdict::pass);
  EXPECT_EQ(tell(Message(second_server).announcement(mapping, {})), Verdict::pass);
  EXPECT_EQ(tell(Message(stranger).announcement(stranger, {})), Verdict::pass);
  EXPECT_EQ(tell(Message(stranger).announcement(glove, {})), Verdict::in_other_name);
}

TEST_F(Book, IsBoundedAndOneHostDoesNotCrowdOutTheOthers) {
  const auto number = [](std::size_t n) {
    GuidPrefix prefix = participant(100);
    prefix[4] = static_cast<std::uint8_t>(n >> 8);
    prefix[5] = static_cast<std::uint8_t>(n);
    return prefix;
  };
  judge(Message(glove).announcement(glove, {}, seconds(20)), at_glove);
  std::size_t passed = 0;
  for (std::size_t n = 0; n < 3 * AddressBook::most_of_one; ++n)
    passed += judge(Message(number(n)).announcement(number(n), {}, seconds(20)), at_stranger) ==
              Verdict::pass;
  EXPECT_EQ(passed, AddressBook::most_of_one);
  EXPECT_EQ(judge(Message(mapping).announcement(mapping, {}, seconds(20)), at_mapping),
            Verdict::pass);
  for (std::size_t n = 0; n < 2 * AddressBook::most; ++n) {
    const Ipv4 from{10, 1, static_cast<std::uint8_t>(n >> 8), static_cast<std::uint8_t>(n)};
    judge(Message(number(10'000 + n)).announcement(number(10'000 + n), {}, seconds(20)), from);
  }
  EXPECT_EQ(book_.size(), AddressBook::most);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove, 10), Verdict::pass);
  // All but the glove have been silent for longer than their lease: there is room again.
  EXPECT_EQ(judge(Message(stranger).announcement(stranger, {}), at_stranger, 25), Verdict::pass);
  EXPECT_EQ(book_.size(), 2u);
  EXPECT_EQ(judge(Message(glove).sample(), at_glove, 26), Verdict::pass);
  for (int n = 0; n < 100; ++n)
    judge(Message(glove).announcement(glove, {{10, 2, 0, static_cast<std::uint8_t>(n)}}), at_glove,
          27);
  int from = 0;
  for (int n = 0; n < 100; ++n)
    from += judge(Message(glove).sample(), Ipv4{10, 2, 0, static_cast<std::uint8_t>(n)}, 28) ==
            Verdict::pass;
  EXPECT_LT(from, static_cast<int>(AddressBook::most_addresses));
}

}  // namespace
}  // namespace prehend::dds
