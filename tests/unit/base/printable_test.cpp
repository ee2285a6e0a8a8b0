// Texts of others on a terminal: every language is read, nothing commands the terminal.
#include "common/base/printable.hpp"

#include <gtest/gtest.h>

namespace prehend {
namespace {

using namespace std::string_literals;

TEST(Printable, TextsOfEveryLanguageStay) {
  for (const auto& text : {""s, "glove"s, "12 µs ± 3 °C"s, "手"s, "prüfstand €"s, "🤖"s})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ControlCharactersAreSpeltOut) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("line\r\nother\ttab"), "line\\x0d\\x0aother\\x09tab");
  EXPECT_EQ(printable("\0\x7f"s), "\\x00\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J")
      << "the second block, as one byte a terminal's CSI";
  EXPECT_EQ(printable("a\nb\x1b", "\n"), "a\nb\\x1b");
}

TEST(Printable, WhatIsNoUtf8IsSpeltOut) {
  EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(printable("a\xc3"), "a\\xc3") << "cut in the middle";
  EXPECT_EQ(printable("\xc3("), "\\xc3(");
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "longer than it need be";
  EXPECT_EQ(printable("\x9b"), "\\x9b");
}

}  // namespace
}  // namespace prehend
