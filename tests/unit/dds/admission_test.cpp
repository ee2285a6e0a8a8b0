// A flood of invented participants does not keep out those who are there.
#include "common/dds/guard/admission.hpp"

#include <gtest/gtest.h>

#include <map>

#include "common/dds/guard/address_book.hpp"
#include "tests/support/packets/packets.hpp"

namespace prehend::dds {
namespace {

using test::Message;

constexpr Time first = Time(std::chrono::hours(1));
constexpr Ipv4 this_host{127, 0, 0, 1};

GuidPrefix invented(std::uint32_t n) {
  GuidPrefix prefix = test::participant(200);
  prefix[0] = 0x81;
  for (int i = 0; i < 4; ++i)
    prefix[static_cast<std::size_t>(4 + i)] = static_cast<std::uint8_t>(n >> 8 * i);
  return prefix;
}

TEST(Admission, ALabThatStartsIsAdmittedAtOnce) {
  Admission admission;
  for (std::uint32_t n = 0; n < 32; ++n) EXPECT_TRUE(admission.admits(invented(n), first)) << n;
  EXPECT_FALSE(admission.admits(invented(99), first));
  EXPECT_TRUE(admission.admits(invented(99), first + seconds(3.0))) << "there is room again";
}

// A hundred thousand in ten seconds.
TEST(Admission, WhoIsThereComesInThroughAFlood) {
  Admission admission;
  int admitted = 0;
  std::map<std::uint32_t, double> met;  // after so many s
  for (std::uint32_t n = 0; n < 100'000; ++n) {
    const double s = n * 1e-4;
    admitted += admission.admits(invented(n + 1000), first + seconds(s));
    // A hundred that are there announce themselves twice a second, each at its own time.
    const std::uint32_t who = n % 5000 / 50;
    if (n % 50 == 0 && s > 1 && !met.contains(who) &&
        admission.admits(invented(who), first + seconds(s)))
      met[who] = s - 1;
  }
  EXPECT_LT(admitted, 32 + 5 + 2);
  EXPECT_EQ(met.size(), 100u);
  int late = 0;
  for (const auto& [who, s] : met) {
    EXPECT_LT(s, 4) << who;
    late += s > 1.01;
  }
  EXPECT_LT(late, 25) << "two had the same place";
}

TEST(Admission, TheBookOfALabWithKeysHasRoomForMembersAndBoundsLeases) {
  AddressBook book(false, true);
  const auto announce = [&](std::uint32_t n, double s, Duration lease = std::chrono::seconds(20)) {
    return book.judge(Message(invented(n)).announcement(invented(n), {}, lease).bytes(), this_host,
                      first + seconds(s));
  };
  EXPECT_EQ(announce(1, 0), PacketVerdict::pass);
  book.let_in(invented(1));
  EXPECT_EQ(announce(2, 0, std::chrono::hours(24)), PacketVerdict::endless);
  // Each twice, so that they are admitted: the book is full.
  for (const double s : {1.0, 1.5, 2.0})
    for (std::uint32_t n = 0; n < 2 * AddressBook::max_here; ++n)
      announce(1000 + n, s, std::chrono::seconds(90));
  EXPECT_EQ(book.size(), AddressBook::max_here + 1);
  EXPECT_EQ(announce(1, 3), PacketVerdict::pass);
  announce(3, 3);
  EXPECT_EQ(announce(3, 3.5), PacketVerdict::too_many);
  announce(3, 8);
  EXPECT_EQ(announce(3, 8.5), PacketVerdict::pass) << "nobody of them has been let in";
  EXPECT_EQ(book.judge(Message(invented(1)).sample().bytes(), this_host, first + seconds(9.0)),
            PacketVerdict::pass);
}

}  // namespace
}  // namespace prehend::dds
