// What is said in plain text in the name of a member of a lab with keys: nothing of it ends the
// membership, nor changes what was announced before the handshake. Times are told.
#include "common/dds/guard/members.hpp"

#include <gtest/gtest.h>

#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Bytes;
using test::Message;
using Verdict = Members::Verdict;

/// With keys: the identity begins with a one.
GuidPrefix with_keys(std::uint8_t n) {
  GuidPrefix prefix = test::participant(n);
  prefix[0] |= 0x80;
  return prefix;
}
const GuidPrefix member = with_keys(1), without_keys = test::participant(2);
constexpr Time beginning = Time(std::chrono::hours(1));
constexpr std::uint32_t a_writer = 0x00000103;

class MembersTest : public testing::Test {
 protected:
  Verdict judge(const Message& message, double s = 0, const GuidPrefix& sender = member) {
    return members_.judge(sender, message.bytes(), beginning + seconds(s));
  }
  Message announcement(Duration lease = std::chrono::seconds(20), const Ipv4& at = {10, 0, 0, 1}) {
    return Message(member).announcement(member, {at}, lease);
  }
  void let_in() {
    EXPECT_EQ(judge(announcement()), Verdict::pass);
    members_.let_in(member);
  }
  Members members_{true};
};

/// One after the other in every form in which an end can be said.
std::vector<Message> departures(const GuidPrefix& of) {
  std::vector<Message> all;
  for (const bool little_endian : {true, false}) {
    const Message in(of, little_endian);
    const Bytes ends = in.list({{0x0070, test::guid(of)}, {0x0071, {0, 0, 0, 3}}}),
                disposed = in.list({{0x0071, {0, 0, 0, 1}}}),
                hash = in.list({{0x0070, test::guid(of)}});
    Bytes content = in.list_head();
    for (const std::uint8_t byte : in.list({{0x0050, test::guid(of)}})) content.push_back(byte);
    all.push_back(Message(in).departure(of));
    all.push_back(Message(in).timestamp().data({.parameters = ends, .content_flag = 0}));
    all.push_back(Message(in).data({.parameters = hash, .content_flag = 0}));
    all.push_back(Message(in).data({.parameters = ends, .content = content}));
    all.push_back(Message(in).data({.parameters = disposed, .content = content}));
    all.push_back(Message(in).data({.parameters = ends, .content = content, .content_flag = 8}));
    all.push_back(
        Message(in).data({.parameters = disposed, .content = test::guid(of), .content_flag = 8}));
    all.push_back(Message(in).data({.parameters = ends, .content = content, .fragment = true}));
    all.push_back(Message(in).data({.content = content, .fragment = true}));
    all.push_back(Message(in).announcement(of, {}).departure(of));
    all.push_back(Message(in).departure(of).announcement(of, {}));
  }
  return all;
}

TEST_F(MembersTest, AMemberDoesNotLeaveInPlainText) {
  let_in();
  for (const Message& message : departures(member)) EXPECT_EQ(judge(message, 1), Verdict::keep);
  EXPECT_EQ(members_.take_forged(), 0u) << "nobody knows yet";
  EXPECT_EQ(judge(announcement(), 1.9), Verdict::pass) << "still on its way";
  EXPECT_EQ(members_.take_forged(), 0u);
  EXPECT_EQ(judge(announcement(), 2.5), Verdict::pass);
  EXPECT_EQ(members_.take_forged(), departures(member).size());
  EXPECT_EQ(members_.take_forged(), 0u);
}

TEST_F(MembersTest, WhoIsSilentAfterItsDepartureHasLeft) {
  let_in();
  const Message departure = Message(member).departure(member);
  judge(departure, 1);
  EXPECT_TRUE(members_.take_departures(beginning + seconds(10.9)).empty());
  EXPECT_EQ(members_.take_departures(beginning + seconds(11.2)),
            std::vector<Bytes>{departure.bytes()});
  EXPECT_TRUE(members_.take_departures(beginning + seconds(12.0)).empty());
}

TEST_F(MembersTest, WhoSpeaksAfterItsDepartureHasNot) {
  let_in();
  judge(Message(member).departure(member), 1);
  judge(announcement(), 3);
  judge(Message(member).departure(member), 4);
  for (double s = 5; s < 30; s += 0.5) {
    EXPECT_TRUE(members_.take_departures(beginning + seconds(s)).empty()) << s;
    judge(announcement(), s);
  }
}

TEST_F(MembersTest, WhoIsNotLetInMayLeave) {
  EXPECT_EQ(judge(announcement()), Verdict::pass);
  for (const Message& message : departures(member)) EXPECT_EQ(judge(message, 1), Verdict::pass);
  EXPECT_EQ(judge(Message(without_keys).announcement(without_keys, {}), 0, without_keys),
            Verdict::pass);
  members_.let_in(without_keys);
  EXPECT_EQ(judge(Message(without_keys).departure(without_keys), 1, without_keys), Verdict::pass);
}

TEST_F(MembersTest, WithoutKeysDeparturesAreBelievedAndCounted) {
  Members plain(false);
  const auto say = [&](const Message& message, double s) {
    return plain.judge(without_keys, message.bytes(), beginning + seconds(s));
  };
  say(Message(without_keys).announcement(without_keys, {}), 0);
  EXPECT_EQ(say(Message(without_keys).departure(without_keys), 1), Verdict::pass);
  EXPECT_EQ(plain.take_forged(), 0u);
  EXPECT_EQ(say(Message(without_keys).sample(), 2.5), Verdict::pass);
  EXPECT_EQ(plain.take_forged(), 1u);
  EXPECT_FALSE(plain.is_stranded(beginning + seconds(9.0))) << "it is met again by itself";
}

TEST_F(MembersTest, WithoutKeysOnlyAnnouncementsAreLookedAt) {
  Members plain(false);
  plain.judge(without_keys, Message(without_keys).sample().bytes(), beginning, false);
  EXPECT_EQ(plain.size(), 0u);
  plain.judge(without_keys, Message(without_keys).announcement(without_keys, {}).bytes(),
              beginning);
  EXPECT_EQ(plain.size(), 1u);
}

TEST_F(MembersTest, NothingButDiscoveryAndHandshakesIsSaidInPlainText) {
  let_in();
  for (const bool little_endian : {true, false}) {
    const Message in(member, little_endian);
    for (const Message& message :
         {Message(in).sample(), Message(in).endpoint(member), Message(in).liveliness(member),
          Message(in).samples(8, a_writer, 1, 1000), Message(in).samples(7, a_writer, 900, 1000),
          Message(in).samples(8, 0x000003c2, 1, 1000), Message(in).samples(7, 0x000100c2, 1, 9),
          Message(in).samples(7, 0xff0202c3, 1, 9),
          Message(in).data({.writer = a_writer, .reader = 0x000100c7}),
          Message(in).data({.writer = 0x000100c2, .reader = 0x000003c7}),
          Message(in).announcement(member, {{10, 0, 0, 1}}).sample()})
      EXPECT_EQ(judge(message), Verdict::not_encrypted);
    EXPECT_EQ(judge(Message(in).data({.writer = 0x000201c3, .content = Bytes(40)})), Verdict::pass);
    EXPECT_EQ(judge(Message(in).samples(7, 0x000003c2, 1, 0)), Verdict::pass);
    EXPECT_EQ(judge(Message(in).timestamp().part(0x31, Bytes(20)).part(0x30, Bytes(100))),
              Verdict::pass);
  }
  EXPECT_EQ(judge(Message(without_keys).sample(), 0, without_keys), Verdict::pass);
}

TEST_F(MembersTest, AMemberStaysWhereItWasWhenItWasLetIn) {
  EXPECT_EQ(judge(announcement({})), Verdict::contradicts) << "it would be gone at once";
  EXPECT_EQ(judge(announcement()), Verdict::pass);
  EXPECT_EQ(judge(announcement(std::chrono::seconds(30))), Verdict::pass) << "who knows";
  members_.let_in(member);
  EXPECT_EQ(judge(announcement()), Verdict::pass);
  EXPECT_EQ(judge(announcement(std::chrono::seconds(20), {10, 0, 0, 2})), Verdict::contradicts);
  EXPECT_EQ(judge(announcement(std::chrono::seconds(40))), Verdict::contradicts);
  EXPECT_EQ(judge(announcement().announcement(member, {})), Verdict::contradicts);
}

TEST_F(MembersTest, BeforeThatItDoesNotSayJustAnything) {
  for (std::uint8_t n = 0; n < Members::max_said; ++n)
    EXPECT_EQ(judge(announcement(std::chrono::seconds(20), {10, 0, 0, n})), Verdict::pass);
  EXPECT_EQ(judge(announcement(std::chrono::seconds(20), {10, 0, 0, 99})), Verdict::contradicts);
}

TEST_F(MembersTest, WhoWasLostAndIsStillThereIsMetAnew) {
  let_in();
  members_.lost(member);
  const auto announce_until = [&](double from, double to) {
    for (double s = from; s <= to; s += 0.5) EXPECT_EQ(judge(announcement(), s), Verdict::pass);
    return members_.is_stranded(beginning + seconds(to));
  };
  EXPECT_FALSE(members_.is_stranded(beginning + seconds(60.0))) << "it is gone";
  EXPECT_FALSE(announce_until(60, 60.5));
  EXPECT_TRUE(announce_until(61, 61));
  // Who shakes hands has a little longer.
  EXPECT_EQ(judge(Message(member).data({.writer = 0x000201c3, .content = Bytes(40)}), 61.1),
            Verdict::pass);
  EXPECT_FALSE(members_.is_stranded(beginning + seconds(61.1)));
  EXPECT_TRUE(announce_until(61.5, 61.5));
  members_.let_in(member);
  EXPECT_FALSE(announce_until(63, 70));
}

TEST_F(MembersTest, WhoSaidThatItLeavesAndDidIsNotMissed) {
  let_in();
  EXPECT_EQ(judge(Message(member).departure(member), 1), Verdict::keep);
  members_.lost(member);
  for (double s = 30; s < 40; s += 0.5) judge(announcement(), s);
  EXPECT_FALSE(members_.is_stranded(beginning + seconds(40.0)))
      << "somebody plays its announcements";
}

TEST_F(MembersTest, IsBounded) {
  let_in();
  for (std::size_t n = 0; n < 2 * Members::max_known; ++n) {
    GuidPrefix prefix = with_keys(100);
    prefix[4] = static_cast<std::uint8_t>(n >> 8);
    prefix[5] = static_cast<std::uint8_t>(n);
    judge(Message(prefix).announcement(prefix, {}), 0, prefix);
  }
  EXPECT_EQ(members_.size(), Members::max_known);
  judge(Message(without_keys).announcement(without_keys, {}), 1000, without_keys);
  EXPECT_EQ(members_.size(), 2u) << "the member and the last one";
}

}  // namespace
}  // namespace prehend::dds
