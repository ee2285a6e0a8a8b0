// Frames of Modbus RTU and registers of Robotiq's grippers: the manufacturer's examples, and what a
// wire does to frames.
#include "services/robot/core/modbus_rtu.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/robot/core/robotiq_protocol.hpp"
#include "tests/unit/robot/hand_of_twelve.hpp"

namespace prehend::robot::modbus {
namespace {

// Robotiq, manual of the 2F-85, control over Modbus RTU: activation, closing, status when grasped.
TEST(ModbusRtu, FramesAreThoseOfTheManual) {
  using namespace robotiq;
  EXPECT_EQ(modbus::encode(write(9, action_at, robotiq::encode(Action{}))),
            bytes_of_hex("091003E800030600000000000073"
                         "30"));
  EXPECT_EQ(modbus::encode(write(9, action_at, robotiq::encode(Action{active, 0, 0, 0}))),
            bytes_of_hex("091003E800030601000000000072E1"));
  EXPECT_EQ(
      modbus::encode(write(9, action_at, robotiq::encode(Action{active | goes, 255, 255, 255}))),
      bytes_of_hex("091003E8000306090000FFFFFF4229"));
  EXPECT_EQ(modbus::encode(read(9, Function::read_input, status_at, register_count)),
            bytes_of_hex("090407D00003B1CE"));
  const auto grasped = only_frame(Parser(Side::answers), bytes_of_hex("090406B90000FFBD005C9A"));
  ASSERT_TRUE(grasped);
  EXPECT_EQ(status_of(*registers_of(*grasped, register_count)),
            (Status{active | goes, Activation::done, Object::while_closing, 0, 255, 189, 0}));
  const auto taken = only_frame(Parser(Side::answers), bytes_of_hex("091003E800030130"));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->function, 16);
}

TEST(ModbusRtu, WhatIsToldIsReadAgain) {
  using namespace robotiq;
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    const auto byte = [&] { return static_cast<std::uint8_t>(random.bits() & 0xff); };
    const Action action{static_cast<std::uint8_t>(byte() & (active | goes)), byte(), byte(),
                        byte()};
    EXPECT_EQ(action_of(robotiq::encode(action)), action);
    const Status status{active,
                        Activation::busy,
                        Object::while_opening,
                        static_cast<std::uint8_t>(byte() & 15),
                        byte(),
                        byte(),
                        byte()};
    EXPECT_EQ(status_of(robotiq::encode(status)), status);
  }
}

// Whatever stands before a frame, and in however many pieces it comes.
TEST(ModbusRtu, FindsFramesAmongOtherBytes) {
  Random random(4);
  for (int n = 0; n < 300; ++n) {
    Parser parser(Side::answers);
    std::string stream;
    for (std::size_t k = random.index(5); k > 0; --k)
      stream += static_cast<char>(0x40 + random.index(32));  // no function
    const bool damaged = !stream.empty();
    stream += bytes_of_hex("090406B90000FFBD005C9A");
    std::optional<Frame> found;
    for (const char c : stream) {
      parser.feed(std::string(1, c));
      if (auto frame = parser.next()) found = frame;
    }
    ASSERT_TRUE(found);
    EXPECT_EQ(found->id, 9);
    EXPECT_EQ(parser.take_broken() > 0, damaged);
  }
}

TEST(ModbusRtu, OneWrongBitAnywhereIsNoFrame) {
  const std::string good = bytes_of_hex("090406B90000FFBD005C9A");
  for (std::size_t i = 0; i < good.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ 1 << bit);
      Parser parser(Side::answers);
      parser.feed(bytes + std::string(300, '\x40'));
      EXPECT_FALSE(parser.next()) << i << ", " << bit;
    }
}

TEST(ModbusRtu, ADeviceRefusesWhatItHasNot) {
  Map map{1000, 2000, Registers(3), {7, 8, 9}};
  const auto code = [&](const Frame& question) {
    const auto said = answer(question, 9, map);
    return said && (said->function & refused) != 0 ? said->data[0] : '\0';
  };
  EXPECT_EQ(code(read(9, Function::read_input, 2000, 4)), 2);
  EXPECT_EQ(code(read(9, Function::read_input, 1999, 1)), 2);
  EXPECT_EQ(code(write(9, 1002, {1, 2})), 2);
  EXPECT_EQ(code({9, 5, "1234"}), 1);
  EXPECT_EQ(code({9, 16, "12"}), 3);
  EXPECT_EQ(map.written, Registers(3)) << "nothing of it was taken";
  EXPECT_FALSE(answer(read(8, Function::read_input, 2000, 3), 9, map)) << "another's";
  EXPECT_EQ(*registers_of(*answer(read(9, Function::read_holding, 2001, 2), 9, map), 2),
            (Registers{8, 9}));
  EXPECT_TRUE(answer(write(9, 1001, {4, 5}), 9, map));
  EXPECT_EQ(map.written, (Registers{0, 4, 5}));
}

}  // namespace
}  // namespace prehend::robot::modbus
