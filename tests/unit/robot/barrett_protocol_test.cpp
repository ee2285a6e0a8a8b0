// Bytes and values of a BarrettHand.
#include "services/robot/core/barrett_protocol.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace prehend::robot::barrett {
namespace {

TEST(BarrettProtocol, CountsAreThoseOfThePublishedRanges) {
  EXPECT_NEAR(counts_per_radian(0) * 140 * std::numbers::pi / 180, 17800, 1e-9);
  EXPECT_NEAR(counts_per_radian(3) * std::numbers::pi, 3150, 1e-9);
}

TEST(BarrettProtocol, PrefixesNameMotors) {
  EXPECT_EQ(motors_of(""), 0b1111u);
  EXPECT_EQ(motors_of("12"), 0b0011u);
  EXPECT_EQ(motors_of("G"), 0b0111u);
  EXPECT_EQ(motors_of("3S"), 0b1100u);
  EXPECT_EQ(motors_of("4"), 0b1000u);
  EXPECT_FALSE(motors_of("5"));
}

TEST(BarrettProtocol, RepliesAreLinesNumbersAndAnError) {
  const Reply numbers_only = parse_reply("0 17800  12 3150\r\n");
  EXPECT_EQ(numbers(numbers_only), (std::vector<int>{0, 17800, 12, 3150}));
  const Reply refused = parse_reply("\r\nERR 64\r\n");
  EXPECT_EQ(refused.error, unknown_parameter);
  EXPECT_TRUE(refused.lines.empty());
  EXPECT_FALSE(numbers(parse_reply("12 x")));
  EXPECT_FALSE(numbers(parse_reply("99999999999")));
}

TEST(BarrettProtocol, ErrorsAreExplained) {
  EXPECT_EQ(explain(over_temperature | not_initialized), "motor not initialized, too hot (8196)");
  EXPECT_EQ(explain(1 << 20), "unknown fault (1048576)");
}

TEST(BarrettProtocol, FeedbackIsBigEndianAndItsTemperatureOfTwoLengths) {
  const std::string motor_bytes_of("\xff\x45\x88\xff\x00\x10\x01\x00\x00\xff\x0c\x4e", 12);
  const auto two = decode(motor_bytes_of + std::string("\x01\x40", 2), 2);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->position, (std::array<int, motors>{17800, 16, 0, 3150}));
  EXPECT_EQ(two->strain[2], 1);
  EXPECT_DOUBLE_EQ(*two->temperature, 32);
  EXPECT_DOUBLE_EQ(*decode(motor_bytes_of + " ", 1)->temperature, 32);
  EXPECT_FALSE(decode(motor_bytes_of, 0)->temperature);
}

TEST(BarrettProtocol, WhatNoHandSaysIsRefused) {
  const std::string zero(14, '\0');
  EXPECT_TRUE(decode(zero, 2));
  EXPECT_FALSE(decode(zero, 1));
  std::string far = zero;
  far[1] = '\x60';  // 24576 counts
  EXPECT_FALSE(decode(far, 2));
  std::string hot = zero;
  hot[12] = '\x7f';
  EXPECT_FALSE(decode(hot, 2));
  std::string before_the_stop = zero;
  before_the_stop[1] = before_the_stop[2] = '\xff';
  EXPECT_EQ(decode(before_the_stop, 2)->position[0], -1);
}

TEST(BarrettProtocol, ControlBlocksAreTheHeaderAndSignedBytes) {
  EXPECT_EQ(control_block({1, -1, 127, -128}), std::string("C\x01\xff\x7f\x80", 5));
}

TEST(BarrettProtocol, NoVelocityIsTheEndOfALine) {
  for (int v = -128; v < 128; ++v) {
    const auto byte = static_cast<std::int8_t>(v);
    const std::string block = control_block({byte, byte, byte, byte});
    EXPECT_EQ(block.find(end_of_line), std::string::npos) << v;
    EXPECT_NEAR(static_cast<signed char>(block[1]), v, 1);
  }
}

}  // namespace
}  // namespace prehend::robot::barrett
