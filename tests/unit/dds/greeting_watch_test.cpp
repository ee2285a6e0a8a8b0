// Which connections stop in their handshake: those that say nothing, or too little for too long,
// and never one that works. Connections and times are told.
#include "common/dds/greeting_watch.hpp"

#include <gtest/gtest.h>

namespace prehend::dds {
namespace {

using Files = std::vector<int>;

/// The listening site: it makes one handshake at a time, in the order of arrival.
class GreetingWatchTest : public testing::Test {
 protected:
  static constexpr Ipv4 here{10, 0, 0, 1}, there{10, 0, 0, 2};
  /// s until all of so many silent ones are cut.
  double until_all_are_cut(int silent) {
    double s = 0;
    for (int left = silent, port = 1; left > 0; s += 0.05)
      if (!watch_.judge({{7, there, static_cast<std::uint16_t>(port), 0}}, at(s)).empty()) {
        --left;
        ++port;
      }
    return s;
  }
  Files judge(const std::vector<GreetingWatch::Connection>& open, double s) {
    return watch_.judge(open, at(s));
  }
  static Time at(double s) { return Time(std::chrono::hours(1)) + seconds(s); }
  GreetingWatch watch_;
};

TEST_F(GreetingWatchTest, OneThatSaysNothingIsCutAfterASecond) {
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 0), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 0.9), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 1.1), Files{7});
  EXPECT_EQ(judge({{7, there, 5001, 0}}, 1.2), Files{}) << "another one with its number";
}

TEST_F(GreetingWatchTest, OneThatStopsOrTricklesIsCut) {
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 0), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 517}}, 0.9), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 517}}, 1.8), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 517}}, 2.0), Files{7});
  double cut = 0;
  for (int i = 0; cut == 0 && i < 100; ++i)
    if (!judge({{8, here, 5000, static_cast<std::uint64_t>(i)}}, 10 + 0.5 * i).empty())
      cut = 0.5 * i;
  EXPECT_NEAR(cut, 5.5, 0.1);
}

TEST_F(GreetingWatchTest, OneThatWorksStaysWhateverItDoes) {
  for (double s = 0; s < 3; s += 0.05)  // a handshake over 200 ms, then announcements
    EXPECT_EQ(judge({{7, there, 5000, static_cast<std::uint64_t>(s / 0.5) * 1000}}, s), Files{});
  for (double s = 3; s < 60; s += 0.5) EXPECT_EQ(judge({{7, there, 5000, 6000}}, s), Files{});
}

TEST_F(GreetingWatchTest, AHundredAreGoneInHalfAMinuteAndOthersKeepTheirTime) {
  EXPECT_LT(until_all_are_cut(100), 40);
  EXPECT_EQ(judge({{7, here, 5000, 0}}, 40), Files{});
  EXPECT_EQ(judge({{7, here, 5000, 0}}, 40.9), Files{}) << "nobody was silent there";
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 200), Files{});
  EXPECT_EQ(judge({{7, there, 5000, 0}}, 200.9), Files{}) << "forgotten after a minute";
}

TEST_F(GreetingWatchTest, ItIsBounded) {
  for (int i = 0; i < 20'000; ++i) {
    const Ipv4 address{10, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    judge({{7, address, 1, 0}}, 3.0 * i);
    judge({{7, address, 1, 0}}, 3.0 * i + 1.5);
  }
  EXPECT_LE(watch_.known_addresses(), GreetingWatch::max_addresses);
}

}  // namespace
}  // namespace prehend::dds
