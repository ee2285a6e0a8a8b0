// A serial port against a pseudo-terminal, as emulated devices are plugged in.
#include "common/serial/serial_port.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "common/serial/pseudo_terminal.hpp"

namespace prehend::serial {
namespace {

constexpr Duration patience = std::chrono::seconds(5);

TEST(SerialPort, CarriesBytesBothWaysAsTheyAre) {
  auto terminal = PseudoTerminal::open({});
  ASSERT_TRUE(terminal);
  auto port = SerialPort::open(terminal->path(), 9600);
  ASSERT_TRUE(port);
  const std::string bytes("\x00\x03\x0d\x0a\x11\x13\xff", 7);
  ASSERT_TRUE(port->write(bytes));
  EXPECT_EQ(terminal->read(patience), bytes);
  terminal->write(bytes);
  EXPECT_EQ(*port->read(patience), bytes);
}

TEST(SerialPort, BelongsToOneAtATime) {
  auto terminal = PseudoTerminal::open({});
  ASSERT_TRUE(terminal);
  std::optional<SerialPort> first;
  auto opened = SerialPort::open(terminal->path(), 9600);
  ASSERT_TRUE(opened);
  first.emplace(std::move(*opened));
  const auto second = SerialPort::open(terminal->path(), 9600);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().what, "another program uses the port");
  first.reset();
  EXPECT_TRUE(SerialPort::open(terminal->path(), 9600));
}

TEST(SerialPort, SaysThatThereIsNone) {
  EXPECT_FALSE(SerialPort::open("/nowhere", 9600));
  EXPECT_FALSE(SerialPort::open("/dev/null", 9600));
}

}  // namespace
}  // namespace prehend::serial
