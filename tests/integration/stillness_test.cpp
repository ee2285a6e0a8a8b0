// What tells the tests of faults that a hand stands still must notice all that moves, and silence.
#include "tests/integration/stillness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace prehend::integration {
namespace {

/// A second of states at 100 Hz, changed by time.
std::optional<std::string> second_of(const std::function<void(v1::HandState&, double t)>& change) {
  Stillness stillness;
  for (int i = 0; i < 100; ++i) {
    v1::HandState state;
    state.dof({0.1, 0.2});
    state.X_WB().orientation().w(1);
    change(state, 0.01 * i);
    stillness.add(state);
  }
  return stillness.complaint(1);
}

TEST(Stillness, AHandThatStandsStillDoes) {
  EXPECT_FALSE(second_of([](auto&, double) {}));
  EXPECT_FALSE(
      second_of([](auto& state, double t) { state.dof()[1] += 0.001 * std::sin(50 * t); }));
}

TEST(Stillness, AnythingThatMovesIsNoticed) {
  EXPECT_TRUE(second_of([](auto& state, double t) { state.dof()[1] += 0.1 * t; }));
  EXPECT_TRUE(second_of([](auto& state, double t) { state.X_WB().position().x(t); }))
      << "an arm that drifts at 1 m/s";
  EXPECT_TRUE(second_of([](auto& state, double t) {
    state.X_WB().orientation().w(std::cos(t / 2));
    state.X_WB().orientation().z(std::sin(t / 2));
  }));
}

TEST(Stillness, SilenceIsNoStandingStill) {
  EXPECT_TRUE(Stillness().complaint(1));
  Stillness once;
  once.add({});
  EXPECT_TRUE(once.complaint(1));
}

}  // namespace
}  // namespace prehend::integration
