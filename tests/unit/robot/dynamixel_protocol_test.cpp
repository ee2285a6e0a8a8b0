// Packets of DYNAMIXEL protocol 2.0: the manufacturer's examples, and what a wire does to packets.
#include "services/robot/core/dynamixel_protocol.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace prehend::robot::dynamixel {
namespace {

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

std::optional<Packet> only_packet(const std::string& bytes) {
  Parser parser;
  parser.feed(bytes);
  auto packet = parser.next();
  EXPECT_FALSE(parser.next());
  return packet;
}

// e-Manual, Protocol 2.0, the examples of ping, read, write, sync read and sync write.
TEST(DynamixelProtocol, PacketsAreThoseOfTheManual) {
  EXPECT_EQ(encode({1, Instruction::ping, {}}),
            bytes_of({0xff, 0xff, 0xfd, 0, 1, 3, 0, 1, 0x19, 0x4e}));
  EXPECT_EQ(encode({1, Instruction::read, read_of(table::present_position)}),
            bytes_of({0xff, 0xff, 0xfd, 0, 1, 7, 0, 2, 0x84, 0, 4, 0, 0x1d, 0x15}));
  EXPECT_EQ(encode({1, Instruction::write, write_of(table::goal_position, 512)}),
            bytes_of({0xff, 0xff, 0xfd, 0, 1, 9, 0, 3, 0x74, 0, 0, 2, 0, 0, 0xca, 0x89}));
  EXPECT_EQ(encode({broadcast, Instruction::sync_read, read_of(table::present_position) + "\1\2"}),
            bytes_of({0xff, 0xff, 0xfd, 0, 0xfe, 9, 0, 0x82, 0x84, 0, 4, 0, 1, 2, 0xce, 0xfa}));
  EXPECT_EQ(encode({broadcast, Instruction::sync_write,
                    read_of(table::goal_position) + "\1" + little_endian(150, 4) + "\2" +
                        little_endian(170, 4)}),
            bytes_of({0xff, 0xff, 0xfd, 0, 0xfe, 0x11, 0,    0x83, 0x74, 0, 4,    0,
                      1,    0x96, 0,    0, 0,    2,    0xaa, 0,    0,    0, 0x82, 0x87}));
}

TEST(DynamixelProtocol, AnswersAreThoseOfTheManual) {
  const auto ping =
      only_packet(bytes_of({0xff, 0xff, 0xfd, 0, 1, 7, 0, 0x55, 0, 6, 4, 0x26, 0x65, 0x5d}));
  ASSERT_TRUE(ping);
  EXPECT_EQ(ping->instruction, Instruction::status);
  EXPECT_EQ(number(std::string_view(ping->parameters).substr(1, 2)), 1030);
  const auto second =
      only_packet(bytes_of({0xff, 0xff, 0xfd, 0, 2, 8, 0, 0x55, 0, 0x1f, 8, 0, 0, 0xba, 0xbe}));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->id, 2);
  EXPECT_EQ(number(std::string_view(second->parameters).substr(1)), 2079);
}

TEST(DynamixelProtocol, NumbersHaveTheirSigns) {
  EXPECT_EQ(number(little_endian(-70000, 4)), -70000);
  EXPECT_EQ(number(little_endian(-300, 2)), -300);
  EXPECT_EQ(number(little_endian(200, 1)), 200);
}

TEST(DynamixelProtocol, WhatLooksLikeAHeaderIsStuffed) {
  const std::string parameters = bytes_of({0xff, 0xff, 0xfd, 0xfd, 0xff, 0xff, 0xff, 0xfd, 0});
  const Packet packet{7, Instruction::write, parameters};
  const std::string sent = encode(packet);
  EXPECT_EQ(sent.size(), 10 + parameters.size() + 2);
  // Only at its begin is there a header.
  EXPECT_EQ(sent.find(bytes_of({0xff, 0xff, 0xfd, 0}), 1), std::string::npos);
  EXPECT_EQ(only_packet(sent), packet);
}

TEST(DynamixelProtocol, AnyBytesGoThroughInAnyPieces) {
  Random random(11);
  Parser parser;
  for (int n = 0; n < 500; ++n) {
    Packet packet{static_cast<std::uint8_t>(random.index(253)), Instruction::status, {}};
    const int values[] = {0xff, 0xfd, 0, 0x55};
    for (std::size_t k = random.index(40); k > 0; --k)
      packet.parameters += static_cast<char>(values[random.index(4)]);
    const std::string sent = encode(packet);
    std::optional<Packet> found;
    for (std::size_t at = 0; at < sent.size(); at += 3) {
      EXPECT_FALSE(found);
      parser.feed(std::string_view(sent).substr(at, 3));
      found = parser.next();
    }
    ASSERT_EQ(found, packet) << n;
  }
  EXPECT_EQ(parser.take_broken(), 0);
}

TEST(DynamixelProtocol, DamageIsFoundAndWhatFollowsIsNotLost) {
  const std::string good = encode({3, Instruction::status, std::string("\0\1\2", 3)});
  for (std::size_t i = 0; i < good.size(); ++i)
    for (const int flip : {1, 0x80}) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ flip);
      Parser parser;
      parser.feed("\x12\xff" + bad);
      EXPECT_FALSE(parser.next()) << i;
      // A length that grew is noticed when enough has come.
      for (int n = 0; n < 200; ++n) parser.feed(good);
      EXPECT_TRUE(parser.next()) << i;
    }
}

TEST(DynamixelProtocol, ErrorsAreExplained) {
  EXPECT_EQ(explain_refusal(alert | access_error), "access error");
  EXPECT_EQ(explain_hardware(overheated | overloaded), "overheated, overload");
  EXPECT_EQ(explain_hardware(0), "no hardware error");
}

}  // namespace
}  // namespace prehend::robot::dynamixel
