// The state machine by itself: each row of its table, and that the weight only ever moves the way
// its phase says and no faster than the ramp.
#include "services/mapping/core/arbitration.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "common/base/random.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

constexpr Duration ramp = std::chrono::milliseconds(300), frame = std::chrono::milliseconds(30);

TEST(Arbitration, RisesWhileAnObjectIsInReachAndFallsWhenItIsLost) {
  Arbitration arbitration(ramp);
  arbitration.step(false, false, frame);
  EXPECT_EQ(arbitration.phase(), Phase::direct);
  for (int i = 1; i <= 9; ++i) {
    arbitration.step(true, false, frame);
    EXPECT_EQ(arbitration.phase(), Phase::engaging);
    EXPECT_NEAR(arbitration.weight(), 0.1 * i, 1e-12);  // sums of a tenth: rounding only
  }
  arbitration.step(true, false, frame);
  arbitration.step(true, false, frame);
  EXPECT_EQ(arbitration.phase(), Phase::engaged);
  EXPECT_EQ(arbitration.weight(), 1);
  for (int i = 1; i <= 9; ++i) {
    arbitration.step(false, false, frame);
    EXPECT_EQ(arbitration.phase(), Phase::leaving);
    EXPECT_NEAR(arbitration.weight(), 1 - 0.1 * i, 1e-12);
  }
  arbitration.step(false, false, frame);
  arbitration.step(false, false, frame);
  EXPECT_EQ(arbitration.phase(), Phase::direct);
  EXPECT_EQ(arbitration.weight(), 0);
}

TEST(Arbitration, KeepsTheObjectWhileItIsTouched) {
  Arbitration arbitration(ramp);
  for (int i = 0; i < 20; ++i) arbitration.step(true, false, frame);
  for (int i = 0; i < 100; ++i) arbitration.step(false, true, frame);
  EXPECT_EQ(arbitration.phase(), Phase::gripping);
  EXPECT_EQ(arbitration.weight(), 1);
  arbitration.step(false, false, frame);
  EXPECT_EQ(arbitration.phase(), Phase::leaving);
}

TEST(Arbitration, ATouchWithoutAnObjectMeansNothing) {
  Arbitration arbitration(ramp);
  for (int i = 0; i < 20; ++i) arbitration.step(false, true, frame);
  EXPECT_EQ(arbitration.phase(), Phase::direct);
  EXPECT_EQ(arbitration.weight(), 0);
}

TEST(Arbitration, EveryTransitionIsReachedAndTheWeightFollowsItsPhase) {
  Random random(11);
  Arbitration arbitration(ramp);
  std::array<bool, transitions.size()> seen{};
  bool in_reach = false, touching = false;
  for (int i = 0; i < 20000; ++i) {
    if (random.uniform() < 0.1) in_reach = !in_reach;
    if (random.uniform() < 0.1) touching = !touching;
    const Phase before = arbitration.phase();
    const double weight = arbitration.weight();
    const Duration elapsed = seconds(random.uniform(0, 0.05));
    arbitration.step(in_reach, touching, elapsed);
    const Phase after = arbitration.phase();
    for (std::size_t t = 0; t < transitions.size(); ++t)
      if (transitions[t].from == before && transitions[t].to == after) seen[t] = true;
    const double change = arbitration.weight() - weight;
    EXPECT_LE(std::abs(change), to_seconds(elapsed) / to_seconds(ramp) + 1e-12);
    if (after == Phase::leaving) {
      EXPECT_LE(change, 0);
    }
    if (after == Phase::engaging || after == Phase::gripping) {
      EXPECT_GE(change, 0);
    }
    if (after == Phase::direct) {
      EXPECT_EQ(arbitration.weight(), 0);
    }
    if (after == Phase::engaged) {
      EXPECT_EQ(arbitration.weight(), 1);
    }
    // A loss never ends a grip.
    if (before == Phase::gripping && touching) {
      EXPECT_EQ(after, Phase::gripping);
    }
  }
  for (std::size_t t = 0; t < transitions.size(); ++t) {
    // A released grip passes through engaging within one step when the object is gone.
    EXPECT_TRUE(seen[t]) << "transition " << t;
  }
}

// The page shows the table that runs. When this fails, put the text it prints on the page.
TEST(Arbitration, IsDrawnInTheDocumentationAsItIs) {
  std::ifstream file(test::in_sources("services/mapping/README.md"));
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find("```mermaid\n" + drawing() + "```\n"), std::string::npos) << drawing();
}

}  // namespace
}  // namespace prehend::mapping
