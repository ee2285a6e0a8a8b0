// Attacks on the gate that were found by trying: each of them once moved a hand that should have
// stayed, or moved it faster than it may.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/gate/fixtures.hpp"

namespace prehend::gate {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

/// A gate before a hand that goes where it is told, beginning at the origin's 0.5 m.
class Attack : public testing::Test {
 protected:
  explicit Attack(bool deadman = false, Limits limits = limits_of(test::hand("barrett")))
      : limits_(std::move(limits)),
        gate_(CommandGate::create(test::hand("barrett"), {.hand = "hand", .deadman = deadman},
                                  limits_, [this] { return here_; })
                  .value()) {}
  /// Sends the hand a metre away, closed, and returns how far the base has gone.
  double leap(std::uint8_t from, int ms) {
    Command sent = command(test::hand("barrett"), from, ms, {1, 0, 0.5});
    sent.sequence = ++sequence_;
    sent.place.dof = test::hand("barrett").clamp(Eigen::VectorXd::Constant(4, 2));
    if (const auto passed = gate_.admit(sent, at(ms))) here_ = passed->place;
    return here_->X_WB.translation().x();
  }
  /// What speed allows in so many ms, and 300.
  double bound(int ms) const { return limits_.base.speed * (1e-3 * ms + 0.3) + 1e-6; }

  Limits limits_;
  std::optional<Place> here_ = open_at(test::hand("barrett"), {0, 0, 0.5});
  CommandGate gate_;
  std::uint64_t sequence_ = 0;
};

TEST_F(Attack, TheLeadThatChangesBeforeEachCommandGivesNoTime) {
  ASSERT_EQ(leap(1, 0), limits_.base.speed * 0.02);
  for (int ms = 1; ms <= 100; ++ms) {
    const std::uint8_t next = ms % 2 ? 2 : 1;
    gate_.take_over(writer(next), at(ms));
    EXPECT_LE(leap(next, ms), limits_.base.speed * (0.02 + 1e-3 * ms) + 1e-6) << ms;
  }
  EXPECT_GT(here_->X_WB.translation().x(), 0.05) << "it moves";
  EXPECT_LE(here_->dof.maxCoeff(), limits_.joint[1].speed * 0.4 + 1e-6);
}

TEST_F(Attack, AStopAndReleaseBeforeEachCommandGiveNoTime) {
  leap(1, 0);
  for (int ms = 1; ms <= 100; ++ms) {
    gate_.stop("anna", "", at(ms));
    gate_.release();
    EXPECT_LE(leap(1, ms), limits_.base.speed * (0.02 + 1e-3 * ms) + 1e-6) << ms;
  }
}

// Nobody knows where the hand is, as of a robot that has lost its line: what it was told counts.
TEST_F(Attack, WhereNobodyKnowsThePlaceNothingLeaps) {
  leap(1, 0);
  const auto told = here_;
  here_.reset();
  gate_.stop("anna", "", at(10));
  gate_.release();
  Command sent = command(test::hand("barrett"), 1, 1000, {1, 0, 0.5});
  const auto passed = gate_.admit(sent, at(1000));
  ASSERT_TRUE(passed);
  EXPECT_LE((passed->place.X_WB.translation() - told->X_WB.translation()).norm(),
            limits_.base.speed * 0.02 + 1e-6);
}

// The robot may refuse what the gate has let through; the hand has not gone there.
TEST_F(Attack, WhatTheRobotDidNotObeyIsNoWay) {
  for (int ms = 0; ms < 1000; ms += 20) {
    Command sent = command(test::hand("barrett"), 1, ms, {1, 0, 0.5});
    sent.sequence = ++sequence_;
    const auto passed = gate_.admit(sent, at(ms));
    ASSERT_TRUE(passed);
    EXPECT_LE(passed->place.X_WB.translation().x(), limits_.base.speed * 0.02 + 1e-6) << ms;
    gate_.start_anew();  // as who could not obey it says
  }
}

class SlowAttack : public Attack {
 protected:
  static Limits slow() {
    Limits limits = limits_of(test::hand("barrett"));
    limits.base.acceleration = 2;
    return limits;
  }
  SlowAttack() : Attack(false, slow()) {}
};

// Each new start is from rest; what may be gained of speed must not come back with it.
TEST_F(SlowAttack, NewStartsGiveNoAcceleration) {
  leap(1, 0);
  for (int ms = 1; ms <= 200; ++ms) {
    gate_.take_over(writer(ms % 2 ? 2 : 1), at(ms));
    leap(ms % 2 ? 2 : 1, ms);
  }
  // From rest with 2 m/s²: 50 ms of it are there at once.
  EXPECT_LE(here_->X_WB.translation().x(), 0.22 * 2 * (0.22 + 0.05));
}

class DeadmanAttack : public Attack {
 protected:
  DeadmanAttack() : Attack(true) {}
};

TEST_F(DeadmanAttack, ConsentThatComesAndGoesGivesNoTime) {
  for (int ms = 0; ms <= 100; ++ms) {
    gate_.consent(writer(9), true, at(2 * ms), at(2 * ms));
    EXPECT_LE(leap(1, 2 * ms), limits_.base.speed * (0.02 + 2e-3 * ms) + 1e-6) << ms;
    gate_.consent(writer(9), false, at(2 * ms) + milliseconds(1), at(2 * ms) + milliseconds(1));
    leap(1, 2 * ms + 1);
  }
}

// Somebody else has spoken in between: what the first one said then is still of then.
TEST_F(DeadmanAttack, ConsentThatIsPlayedAgainIsNone) {
  const auto stays_refused = [&](int ms) {
    Command sent = command(test::hand("barrett"), 1, ms);
    sent.sequence = ++sequence_;
    EXPECT_FALSE(gate_.admit(sent, at(ms))) << ms;
  };
  gate_.consent(writer(8), true, at(0), at(0));
  gate_.consent(writer(8), false, at(10), at(10));
  gate_.consent(writer(9), true, at(20), at(20));
  gate_.consent(writer(9), false, at(30), at(30));
  gate_.consent(writer(8), true, at(0), at(40));  // both of then
  stays_refused(41);
  gate_.consent(writer(9), true, at(20), at(42));
  stays_refused(43);
  // Nor does a crowd make the gate forget.
  for (std::uint8_t other = 20; other < 100; ++other)
    gate_.consent(writer(other), true, at(44), at(44));
  gate_.consent(writer(20), false, at(45), at(45));
  for (std::uint8_t other = 21; other < 100; ++other)
    gate_.consent(writer(other), false, at(45), at(45));
  gate_.consent(writer(8), true, at(0), at(46));
  stays_refused(160);
  gate_.consent(writer(8), true, at(200), at(200));
  gate_.consent(writer(8), false, at(201), at(201));
  for (int ms = 202; ms < 600; ++ms) {
    gate_.consent(writer(8), true, at(200), at(ms));  // again and again
    stays_refused(ms);
  }
}

TEST_F(DeadmanAttack, ConsentOfStampsThatOverflowIsNone) {
  for (const std::int64_t ns :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
        to_ns(at(0)) + std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0},
        std::int64_t{4294967295}}) {
    gate_.consent(writer(9), true, from_ns(ns), at(0));
    EXPECT_FALSE(gate_.has_consent(at(0))) << ns;
  }
}

TEST_F(Attack, ANumberThatWasSeenIsNotObeyedWithANewStamp) {
  leap(1, 0);
  Command again = command(test::hand("barrett"), 1, 0);
  again.sequence = sequence_;
  for (int ms = 1; ms < 250; ms += 10) {
    again.stamp = at(ms);
    const auto passed = gate_.admit(again, at(ms));
    ASSERT_FALSE(passed) << ms;
    EXPECT_EQ(passed.error(), Refusal::not_newer);
  }
}

// One who counts cannot say that he does not.
TEST_F(Attack, AZeroInBetweenIsNotObeyed) {
  leap(1, 0);
  Command zero = command(test::hand("barrett"), 1, 10);
  zero.sequence = 0;
  EXPECT_FALSE(gate_.admit(zero, at(10)));
  zero.stamp = at(20);
  EXPECT_FALSE(gate_.admit(zero, at(20)));
}

TEST_F(Attack, StampsThatOverflowAreRefused) {
  using Limits64 = std::numeric_limits<std::int64_t>;
  for (const std::int64_t ns :
       {Limits64::min(), Limits64::min() + 1, Limits64::max(), Limits64::max() - 1,
        to_ns(at(0)) + Limits64::min(), std::int64_t{-1}, std::int64_t{0}, std::int64_t{4294967295},
        std::int64_t{4294967296}, -to_ns(at(0))}) {
    Command sent = command(test::hand("barrett"), 1, 0);
    sent.sequence = ++sequence_;
    sent.stamp = from_ns(ns);
    const auto passed = gate_.admit(sent, at(0));
    ASSERT_FALSE(passed) << ns;
    EXPECT_EQ(passed.error(), sent.stamp < at(0) ? Refusal::too_old : Refusal::from_future) << ns;
  }
  EXPECT_FALSE(gate_.leader(at(0)));
}

// The limiter by itself: whatever stamps say, and a clock that goes back.
TEST_F(Attack, StampsThatOverflowGiveTheLimiterNoTime) {
  MotionLimiter limiter(limits_);
  limiter.start(open_at(test::hand("barrett"), {0, 0, 0.5}));
  double x = 0;
  for (int i = 0; i < 50; ++i) {
    const std::int64_t ns =
        i % 2 ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
    x = limiter.step(open_at(test::hand("barrett"), {9, 0, 0.5}), from_ns(ns), at(i % 3 ? i : -i))
            .place.X_WB.translation()
            .x();
  }
  EXPECT_LE(x, bound(50));
}

// A crowd of writers makes the gate forget nobody whose commands could come a second time.
TEST_F(Attack, ACrowdDoesNotLetOldCommandsThrough) {
  leap(1, 0);
  Command old = command(test::hand("barrett"), 1, 0);
  old.sequence = sequence_;
  for (std::uint8_t other = 2; other < 60; ++other) {
    Command sent = command(test::hand("barrett"), other, 1);
    EXPECT_FALSE(gate_.admit(sent, at(1)));
  }
  EXPECT_FALSE(gate_.admit(old, at(2))) << "doubled";
  leap(1, 10);
  EXPECT_EQ(gate_.leader(at(10)), writer(1)) << "nor does it push out who leads";
  // Who is named leads, though the gate is full.
  gate_.take_over(writer(100), at(11));
  EXPECT_TRUE(gate_.admit(command(test::hand("barrett"), 100, 11), at(11)));
}

// Who asked for the release knew nothing of the stop that came after it.
TEST_F(Attack, AReleaseOfBeforeTheStopIsNone) {
  EXPECT_TRUE(gate_.may_release(at(0)));
  gate_.stop("anna", "", at(10));
  EXPECT_FALSE(gate_.may_release(at(5)));
  EXPECT_TRUE(gate_.may_release(at(11)));
  gate_.stop("ben", "", at(20));
  EXPECT_FALSE(gate_.may_release(at(15))) << "the second stop counts as well";
  EXPECT_TRUE(gate_.may_release(at(21)));
  EXPECT_EQ(gate_.stopped()->since, at(10));
}

TEST_F(Attack, AGateForCommandsOfAnyAgeIsNotMade) {
  for (const Duration age : {Duration::max(), Duration::min(), Duration(std::chrono::hours(1))})
    EXPECT_FALSE(
        CommandGate::create(test::hand("barrett"), {.hand = "hand", .max_age = age}, limits_));
}

}  // namespace
}  // namespace prehend::gate
