// How a hand may be before it closes.
#include "common/grasping/preshapes.hpp"

#include <gtest/gtest.h>

#include "tests/support/hands.hpp"

namespace prehend::grasping {
namespace {

TEST(Preshapes, AreOpenWithAndWithoutWhatDoesNotCloseAndThoseThatTheHandHas) {
  const auto& spread = test::hand("barrett").dofs().front();
  ASSERT_EQ(spread.closing, 0);
  const auto made = preshapes_of(test::hand("barrett"));
  ASSERT_EQ(made.size(), 4u);
  EXPECT_EQ(made[0], test::hand("barrett").postures().at("open"));
  EXPECT_NEAR(made[1][0], (spread.upper - spread.lower) / 12, 1e-9);
  EXPECT_NEAR(made[2][0], (spread.upper - spread.lower) / 2, 1e-9);
  EXPECT_NEAR(made[3][0], (spread.upper - spread.lower) / 3, 1e-9);
  for (const auto& each : made) EXPECT_EQ(each.tail(3), made[0].tail(3)) << "fingers are open";
  // All its DoFs close: only its own postures are left, and of these not the closed one.
  const auto& jaw = test::hand("parallel_jaw");
  const auto of_jaw = preshapes_of(jaw);
  ASSERT_EQ(of_jaw.size(), 1u) << "the jaws must have half their way before them";
  EXPECT_EQ(of_jaw[0], jaw.postures().at("open"));
}

TEST(Preshapes, KeepTheLimitsOfEveryHand) {
  for (const std::string& name : test::hand_names()) {
    const auto& hand = test::hand(name);
    for (const Eigen::VectorXd& each : preshapes_of(hand))
      EXPECT_EQ(each, hand.clamp(each)) << name;
  }
}

TEST(WaysToClose, KeepTheLimitsOfEveryHandAndLeaveSomethingToClose) {
  for (const std::string& name : test::hand_names()) {
    const auto& hand = test::hand(name);
    const auto ways = ways_to_close(hand);
    ASSERT_FALSE(ways.empty()) << name;
    EXPECT_TRUE(ways.front().resting.empty()) << name << ": all fingers first";
    for (const Preshape& way : ways) {
      EXPECT_EQ(way.dof, hand.clamp(way.dof)) << name;
      if (way.resting.empty()) continue;
      ASSERT_EQ(way.resting.size(), hand.dofs().size()) << name;
      int closing = 0;
      for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
        closing += hand.dofs()[i].closing != 0 && !way.resting[i];
        EXPECT_FALSE(hand.dofs()[i].closing == 0 && way.resting[i]) << name << ": rests anyway";
      }
      EXPECT_GE(closing, 2) << name;
    }
  }
}

// A thumb that is turned against the fingers and wide open; little and ring finger stay out of it.
TEST(WaysToClose, OpposeTheThumbAndLeaveFarFingersOut) {
  const auto& hand = test::hand("robonaut");
  const auto dof = [&](const std::string& name) {
    for (std::size_t i = 0; i < hand.dofs().size(); ++i)
      if (hand.dofs()[i].name == name) return i;
    ADD_FAILURE() << name;
    return std::size_t{0};
  };
  const std::size_t roll = dof("thumb roll"), proximal = dof("thumb proximal");
  const std::size_t little = dof("little proximal"), ring = dof("ring proximal");
  const std::size_t index = dof("index proximal");
  int without_little = 0, without_both = 0;
  for (const Preshape& way : ways_to_close(hand)) {
    const auto at = [&](std::size_t k) { return way.dof[static_cast<Eigen::Index>(k)]; };
    if (std::abs(at(roll) - hand.postures().at("power")[static_cast<Eigen::Index>(roll)]) > 1e-9 ||
        std::abs(at(proximal) - hand.dofs()[proximal].lower) > 1e-9 || way.resting.empty())
      continue;
    EXPECT_FALSE(way.resting[index]);
    without_both += way.resting[little] && way.resting[ring];
    without_little += way.resting[little] && !way.resting[ring];
  }
  EXPECT_GE(without_little, 1);
  EXPECT_GE(without_both, 1);
}

}  // namespace
}  // namespace prehend::grasping
