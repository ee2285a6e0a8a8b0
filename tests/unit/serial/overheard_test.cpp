// Who speaks at a port where a device does not answer: the kinds that users plug in by mistake,
// each told apart and quoted in one line.
#include "common/serial/overheard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/serial/pseudo_terminal.hpp"
#include "common/serial/serial_port.hpp"

namespace prehend::serial {
namespace {

using testing::HasSubstr;
using testing::Not;

Error told(std::string_view heard, std::string_view said = "?S") {
  Overheard ear;
  ear.said(said);
  ear.heard(heard);
  return ear.unanswered({"the glove does not answer", "/dev/ttyUSB0", "check that it is on"});
}

TEST(Overheard, ASilentLineKeepsItsError) {
  EXPECT_EQ(told("").message(), "/dev/ttyUSB0: the glove does not answer (check that it is on)");
}

TEST(Overheard, TellsKindsApartAndQuotesThem) {
  EXPECT_THAT(told("\x03?S", "\x03?S").message(),
              HasSubstr("heard instead: «\\x03?S» (our own words come back"));
  EXPECT_THAT(
      told("20000.00,N*40\r\n$GPGGA,120000.00,5000.0000,N,00800.0000,E,1\r\n$GPG").message(),
      HasSubstr("«$GPGGA,120000.00,5000.0000,N,00800.0000,...» (that is a GPS receiver"));
  EXPECT_THAT(told("\r\nsketch v0.3 ready\r\n> ").message(),
              HasSubstr("«sketch v0.3 ready» (another device"));
  EXPECT_THAT(told("login: ").message(), HasSubstr("«login: » (another device"));
  EXPECT_THAT(told("\xf8\x80\x1e\xe0\xfe").message(),
              HasSubstr("«\\xf8\\x80\\x1e\\xe0\\xfe» (no text and no answer: check the baud rate"));
}

TEST(Overheard, AQuoteIsShortAndStaysOnItsLine) {
  std::string bytes;
  for (int c = 0; c < 256; ++c) bytes += static_cast<char>(c);
  for (const std::string& heard :
       {bytes + bytes, std::string(5000, 'x'), std::string("\x1b[2J\x1b[H\n")}) {
    const std::string message = told(heard).message();
    EXPECT_THAT(message, HasSubstr("heard instead"));
    EXPECT_THAT(message, Not(HasSubstr("\x1b")));
    EXPECT_THAT(message, Not(HasSubstr("\n")));
    const std::size_t begin = message.find("«");
    EXPECT_LE(message.find("»") - begin, 50u) << message;
  }
}

TEST(Overheard, ThatItQuotesSomethingElseIsNoNews) {
  const auto news = [](const std::string& heard, const std::string& before) {
    return is_news(told(heard).message(), told(before).message());
  };
  EXPECT_FALSE(news("one\n", "two\n"));
  EXPECT_TRUE(news("one\n", ""));
  EXPECT_TRUE(news("", "one\n"));
  EXPECT_FALSE(is_news("the port has disappeared", "the port has disappeared"));
  EXPECT_TRUE(is_news("the port has disappeared", told("one\n").message()));
  // Guards: on a busy machine the end of a greeting was quoted, «> », and never what it greets
  // with.
  EXPECT_TRUE(news("ready\n> ", "> "));
  EXPECT_FALSE(news("> ", "ready\n> "));
  EXPECT_FALSE(news("> ", "$ "));
}

TEST(Overheard, APortRemembersBothSides) {
  auto terminal = PseudoTerminal::open({});
  ASSERT_TRUE(terminal);
  auto port = SerialPort::open(terminal->path(), 9600);
  ASSERT_TRUE(port);
  EXPECT_FALSE(port->overheard().speaker());
  ASSERT_TRUE(port->write("who?\r"));
  terminal->write(terminal->read(std::chrono::seconds(5)));
  ASSERT_TRUE(port->read(std::chrono::seconds(5)));
  EXPECT_EQ(port->overheard().speaker(), Speaker::ourselves);
}

}  // namespace
}  // namespace prehend::serial
