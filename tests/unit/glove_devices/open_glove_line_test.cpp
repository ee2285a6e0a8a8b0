// Lines of open gloves: what is documented is read, and what is damaged is none.
#include "services/glove/devices/open_glove_line.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace prehend::glove::open_glove {
namespace {

TEST(OpenGloveLine, IsReadAsDocumented) {
  const auto sample = parse("A100B2047C4095D0E12F2048G2048P77(AB)12(EB)4000JNM\r");
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->fingers, (std::array{100, 2047, 4095, 0, 12}));
  EXPECT_EQ(sample->held, (std::vector<std::uint8_t>{1, 5}));  // A and menu; pinch is no button
}

TEST(OpenGloveLine, WhatIsDamagedIsNone) {
  for (const char* line :
       {"", "A1B2C3D4E5", "A1B2C3D4F1G1", "A1B2C3D4E4096F1G1", "A-1B2C3D4E5F1G1", "AB2C3D4E5F1G1",
        "A1A1B2C3D4E5F1G1", "A1B2C3D4E5F1G1JJ", "A1B2C3D4E5F1G1?", "A1B2C3D4E5F1G1(AB",
        "A1B2C3D4E5F1G1(AB)", "A99999999999B2C3D4E5F1G1", "$GPGGA,1,2"})
    EXPECT_FALSE(parse(line)) << line;
  // Our own words, if they come back.
  const std::string ours = to_line(HeldBack{});
  EXPECT_FALSE(parse(ours.substr(0, ours.size() - 1)));
}

TEST(OpenGloveLine, TellsHowFarEachFingerIsHeldBack) {
  EXPECT_EQ(to_line(HeldBack{}), "A0B0C0D0E0\n");
  const std::string line = to_line(HeldBack{0, 0.25, 0.5, 1, 7});
  EXPECT_EQ(line, "A0B250C500D1000E1000\n");
  EXPECT_EQ(parse_held_back("A0B250C500D1000E1000"), (HeldBack{0, 0.25, 0.5, 1, 1}));
  for (const char* wrong : {"", "A0B0C0D0", "A0B0C0D0E1001", "A0B0C0D0E0E0", "A0B0C0D0F0",
                            "A0B0C0D0E0F0", "A0B0C0D0E", "A1B2C3D4E5F1G1"})
    EXPECT_FALSE(parse_held_back(wrong)) << wrong;
}

TEST(OpenGloveLine, ComesBackAsItWent) {
  Random random(1);
  for (int n = 0; n < 1000; ++n) {
    Sample sample;
    for (int& finger : sample.fingers) finger = static_cast<int>(random.index(full + 1));
    for (std::uint8_t button = 1; button <= buttons; ++button)
      if (random.uniform() < 0.3) sample.held.push_back(button);
    const std::string line = to_line(sample);
    ASSERT_LE(line.size(), max_line);
    LineParser parser;
    std::vector<std::string> lines;
    for (const char byte : line)
      for (std::string& whole : parser.feed({&byte, 1})) lines.push_back(std::move(whole));
    ASSERT_EQ(lines.size(), 1U);
    const auto read = parse(lines[0]);
    ASSERT_TRUE(read) << line;
    EXPECT_EQ(read->fingers, sample.fingers);
    EXPECT_EQ(read->held, sample.held);
  }
}

TEST(OpenGloveLine, AnOverlongOneIsCountedOnceAndTheNextIsRead) {
  LineParser parser;
  EXPECT_TRUE(parser.feed(std::string(10'000, 'A')).empty());
  EXPECT_TRUE(parser.feed("\n").empty());
  EXPECT_EQ(parser.take_overlong(), 1U);
  EXPECT_EQ(parser.take_overlong(), 0U);
  EXPECT_EQ(parser.feed("A1\n"), std::vector<std::string>{"A1"});
}

}  // namespace
}  // namespace prehend::glove::open_glove
