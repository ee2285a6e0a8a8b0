// Each driver with each fault that its emulator makes, in computed time: either the hand is led on,
// or it is named, held and ready again, each within what the driver's options and the fault allow.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/wires/fault_play.hpp"

namespace prehend::test {
namespace {

using testing::HasSubstr;

/// What comes of a fault.
struct Outcome {
  bool led_on = false, named = false;  // allowed; chance decides where both are
  std::string words;                   // that name it
  double named_in = 0, held_in = 0;    // s, after its begin
};

const double lost_after = to_seconds(robot::DriverOptions{}.lost_after);
const double in_time = lost_after + 0.02;  // s, that silence is noticed in

Outcome by(std::string words, double named_in, double held_in) {
  return {false, true, std::move(words), named_in, held_in};
}

/// Of a share of the answers: few are left out, of all there may be nothing else.
Outcome spoilt(const WiredHand& wired, std::string_view fault) {
  const bool few = fault.ends_with("10 %");
  const bool finds_its_frames = wired.driver != "barrett" && wired.driver != "ros2_control";
  const bool late = fault.starts_with("late");
  Outcome outcome = by(wired.driver == "ros2_control" ? "its joint states" : "the wire is lost",
                       fault_lasts, fault_lasts + lost_after);
  outcome.led_on = few || (fault == "garbage" && finds_its_frames) || fault == "swap-bytes" ||
                   (late && (wired.driver == "dynamixel" || wired.driver == "ros2_control"));
  outcome.named = !few || late;  // several of them in a row are silence
  return outcome;
}

Outcome of(const WiredHand& wired, std::string_view fault) {
  // Its motors keep their velocity until they are told another, and nobody can tell them.
  const double silent = wired.driver == "barrett" ? fault_lasts + 0.15 : in_time + 0.1;
  const bool topics = wired.driver == "ros2_control";
  if (fault == "silence")
    return by(topics ? "its joint states have fallen silent" : "the wire is lost", in_time, silent);
  if (fault == "cut") return by("the port has disappeared", 0.01, silent);
  if (fault == "hot") {
    const double asked_every = wired.driver == "dynamixel" ? 1.1 : 0.1;
    return by(wired.driver == "dynamixel" ? "overheated" : "too hot", asked_every, asked_every);
  }
  if (fault == "stuck") return by(wired.driver == "inspire_rh56" ? "stalled" : "stuck", 1.6, 1.7);
  if (fault == "restart") {
    if (wired.driver == "barrett") return by("the wire is lost", in_time, in_time);
    if (wired.driver == "dynamixel") return by("has lost its torque", 1.1, 1.1);
    if (wired.driver == "robotiq_2f85") return by("has lost its activation", 0.1, 0.1);
    return {.led_on = true, .words = {}};  // nothing is lost with their power
  }
  // Nobody was silent; but these have moved unwatched meanwhile, or been stopped by their own dogs.
  if (fault == "held-up") {
    Outcome outcome = by("as this machine was too busy", 0.52, 0.62);
    outcome.led_on = wired.driver != "dynamixel";
    outcome.named = wired.driver == "dynamixel" || wired.driver == "barrett";
    return outcome;
  }
  if (fault == "answers-as") return by("does not answer, but id 3 does", in_time, 0);
  if (fault == "other joints") return by("its joint states do not name", in_time, in_time + 0.1);
  if (fault == "out of range") return by("its joint states jump", in_time, in_time + 0.1);
  return spoilt(wired, fault);
}

class Faults : public testing::TestWithParam<WiredHand> {};

TEST_P(Faults, AreNamedHeldAndMadeGoodInTime) {
  const WiredHand& wired = GetParam();
  for (const PlayedFault& fault : played_faults()) {
    if (!fault.befalls(wired)) continue;
    const Outcome outcome = of(wired, fault.name);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const FaultPlay played = play(wired, fault, seed);
      SCOPED_TRACE(wired.driver + ", " + std::string(fault.name) + ", seed " +
                   std::to_string(seed) + ": " + played.words);
      EXPECT_TRUE(played.follows);
      // What a message without a sum says may be anything, if each is spoilt.
      if (wired.driver != "ros2_control" || fault.name.ends_with("10 %")) {
        EXPECT_LT(played.astray, 0.25);
      }
      EXPECT_TRUE(played.named ? outcome.named : outcome.led_on);
      if (!played.named) continue;
      EXPECT_THAT(played.words, HasSubstr(outcome.words));
      EXPECT_LE(*played.named, outcome.named_in);
      EXPECT_LE(played.held.value_or(100), outcome.held_in);
      EXPECT_LE(played.ready.value_or(100), played.homed ? 6 : 2.5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Faults, testing::ValuesIn(wired_hands()),
                         [](const auto& wired) { return wired.param.driver; });

}  // namespace
}  // namespace prehend::test
