// Captures of real trackers: every record, and the same orientation from matrix and angles.
#include "services/glove/devices/bird_capture.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/shared_data.hpp"

namespace prehend::glove::bird {
namespace {

namespace fs = std::filesystem;

fs::path captures() {
  return shared_data() / "flock_of_birds_captures";
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const std::string small =
    "1.5  :    (DEBUG) # a comment\n\n"
    "1.6  :    (INFO) 1. command[2] O\\x03\n"
    "1.7  :    (INFO) 1. receive[2] \\x01\\x00\n"
    "1.8  :    (INFO) 2. command[1] V\n"
    "1.9  :    (INFO) 3. command[2] M\\x01\n"
    "2.0  :    (INFO) 4. command[1] B\n"
    "2.1  :    (INFO) 4. receive[7] \\x80\\x20\\\\\\x00\\x00\\x60\\x01\n";

TEST(BirdCapture, ReadsRangeFormatAndButtonFromTheConversation) {
  const auto capture = read_capture(small, "small");
  ASSERT_TRUE(capture);
  ASSERT_EQ(capture->records.size(), 1u);
  const Record& record = capture->records[0].record;
  EXPECT_DOUBLE_EQ(capture->records[0].time, 2.1);
  EXPECT_EQ(record.format, Format::position);
  // 0x20 << 9 = 16384 of 32768 of 72 inches; 0x5c << 2 = 368; 0x60 << 9 is -16384.
  EXPECT_DOUBLE_EQ(record.position->x(), 36 * inch);
  EXPECT_DOUBLE_EQ(record.position->y(), 368.0 / 32768 * 72 * inch);
  EXPECT_DOUBLE_EQ(record.position->z(), -36 * inch);
  EXPECT_EQ(record.button, 1);
  EXPECT_EQ(capture->garbage, 0u);
  EXPECT_EQ(capture->unreadable_lines, 0u);
}

TEST(BirdCapture, UnescapesAndRefusesBrokenEscapes) {
  EXPECT_EQ(unescape("a\\x41\\\\"), "aA\\");
  for (const char* broken : {"\\", "\\x", "\\x4", "\\xg0", "\\n"}) EXPECT_FALSE(unescape(broken));
}

TEST(BirdCapture, ReadsBothRealCaptures) {
  if (!fs::exists(captures())) GTEST_SKIP() << "no " << captures();
  const auto march = read_capture(text_of(captures() / "flockofbirds_stream_03_21_2006.txt"), "3");
  const auto may = read_capture(text_of(captures() / "flockofbirds_stream_05_31_2006.txt"), "5");
  ASSERT_TRUE(march && may);
  // As many as the files have `receive` lines that answer B or @: 10, and 1 + 10.
  EXPECT_EQ(march->records.size(), 10u);
  ASSERT_EQ(may->records.size(), 11u);
  for (const auto* capture : {&*march, &*may}) {
    EXPECT_EQ(capture->garbage, 0u);
    EXPECT_EQ(capture->unreadable_lines, 0u);
    for (const CapturedRecord& captured : capture->records) {
      ASSERT_TRUE(captured.record.position && captured.record.rotation());
      EXPECT_LT(captured.record.position->norm(), short_range);
    }
  }
  for (const CapturedRecord& captured : march->records)
    EXPECT_NEAR(captured.record.quaternion->norm(), 1, 0.002);
  for (const CapturedRecord& captured : may->records) EXPECT_EQ(captured.record.button, 0);
  // One matrix, then angles of the same still sensor: they agree to the sensor's jitter.
  ASSERT_TRUE(may->records[0].record.matrix && may->records[1].record.angles);
  const auto difference = *may->records[0].record.rotation() - *may->records[1].record.rotation();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.001);
}

TEST(BirdCapture, RefusesOtherTexts) {
  EXPECT_FALSE(read_capture("", "empty"));
  EXPECT_FALSE(read_capture("Copyright Information\nThe license …\n", "licence"));
}

}  // namespace
}  // namespace prehend::glove::bird
