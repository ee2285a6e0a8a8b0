// Which two hands are asked for, and what is said where that is no pair of hands.
#include <gtest/gtest.h>

#include "services/cli/tools/demo/carry_play.hpp"

namespace prehend::cli {
namespace {

std::string refused(const std::vector<std::string>& entries) {
  CarryOptions options;
  const auto read = read_hands(entries, options);
  return read ? "taken" : read.error().what;
}

TEST(CarryHands, ALeftHandIsTheMirrorImageOfAKnownOne) {
  CarryOptions options;
  ASSERT_TRUE(read_hands({"right:dlr", "left:barrett"}, options));
  EXPECT_EQ(options.left, "barrett_left");
  EXPECT_EQ(options.right, "dlr");
  ASSERT_TRUE(read_hands({"left:barrett_left", "right:barrett"}, options));
  EXPECT_EQ(options.left, "barrett_left");
}

TEST(CarryHands, WhatIsNoPairIsNamed) {
  EXPECT_EQ(refused({"left:barrett"}), "names one hand");
  for (const std::string wrong : {"barrett", "left:", ":barrett", "up:barrett", ""})
    EXPECT_EQ(refused({wrong, "right:barrett"}), "«" + wrong + "» is no hand");
  EXPECT_EQ(refused({"left:barrett", "left:dlr"}), "«left:dlr» is no hand");
  EXPECT_EQ(refused({"left:teapot", "right:barrett"}), "'teapot_left' is no hand");
  EXPECT_EQ(refused({"left:barrett", "right:teapot"}), "'teapot' is no hand");
}

}  // namespace
}  // namespace prehend::cli
