// The emulated tracker: what the driver is tested against must itself do what a tracker does.
#include "services/glove/devices/bird_emulator.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/glove/devices/bird_words.hpp"

namespace prehend::glove::bird {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Duration ms(int n) {
  return std::chrono::milliseconds(n);
}

Frame some_frame() {
  Frame frame;
  for (int s = 0; s < 4; ++s)
    frame.readings.push_back({usual_sites()[static_cast<std::size_t>(s)], true,
                              Vector3d(0.1 * s, 0.2, -0.3), Quaterniond::Identity()});
  return frame;
}

TEST(BirdEmulator, NeedsItsTimeAfterResetAndAutoConfigure) {
  Emulator tracker({});
  using std::string_literals::operator""s;
  EXPECT_EQ(tracker.receive("O\x24"s, ms(0)), "\xE0\xA0\xA0\xA0"s + std::string(10, '\0'));
  EXPECT_EQ(tracker.receive("P\x32\x04"s, ms(1)), "");
  EXPECT_EQ(tracker.receive("O\x24"s, ms(200)), "") << "still busy: the command is lost";
  EXPECT_EQ(tracker.receive("O\x24"s, ms(400)), "\xE0\xE0\xE0\xE0"s + std::string(10, '\0'));
  EXPECT_EQ(tracker.receive("/"s, ms(500)), "");
  EXPECT_EQ(tracker.receive("O\x24"s, ms(600)), "");
  EXPECT_EQ(tracker.receive("O\x24"s, ms(800)), "\xE0\xA0\xA0\xA0"s + std::string(10, '\0'));
}

std::string joined(const std::vector<std::string>& records) {
  std::string bytes;
  for (const std::string& record : records) bytes += record;
  return bytes;
}

TEST(BirdEmulator, StreamsGroupsInTheFormatsAskedFor) {
  using std::string_literals::operator""s;
  Emulator tracker({});
  tracker.receive("P\x32\x04"s, ms(0));
  for (char unit = 1; unit <= 4; ++unit)
    tracker.receive(std::string(1, static_cast<char>(0xF0 + unit)) + "P\x03\x01\x00"s, ms(700));
  tracker.receive("P\x23\x01\xF1Z\xF2Z\xF3Z\xF4Z@"s, ms(700));
  EXPECT_TRUE(tracker.streaming());
  RecordParser parser({.format = Format::position_matrix, .group = true, .range = long_range});
  const auto records = parser.feed(joined(tracker.measure(some_frame(), ms(710))));
  ASSERT_EQ(records.size(), 4u);
  for (int s = 0; s < 4; ++s) {
    EXPECT_EQ(*records[static_cast<std::size_t>(s)].address, s + 1);
    EXPECT_NEAR(records[static_cast<std::size_t>(s)].position->x(), 0.1 * s, 2e-4);
  }
  tracker.receive("\x13"s, ms(720));
  EXPECT_TRUE(tracker.measure(some_frame(), ms(730)).empty()) << "XOFF";
  tracker.receive("\x11"s, ms(740));
  EXPECT_FALSE(tracker.measure(some_frame(), ms(750)).empty()) << "XON";
  EXPECT_EQ(tracker.receive("B"s, ms(760)).size(), 4 * 25u) << "one more of each, then point mode";
  EXPECT_TRUE(tracker.measure(some_frame(), ms(770)).empty());
}

// Each unit has its own settings; on the wrong side of the transmitter a sensor is seen opposite.
TEST(BirdEmulator, KeepsFormatButtonAndHemisphereOfEachUnit) {
  using std::string_literals::operator""s;
  Emulator tracker({.sites = {Site::back_of_hand, Site::thumb}});
  tracker.receive("P\x32\x02"s, ms(0));
  tracker.receive("P\x23\x01\xF1V\xF2]\xF2M\x01\xF2L\x06\x01@"s, ms(700));
  const auto records = tracker.measure(some_frame(), ms(710));
  ASSERT_EQ(records.size(), 2u);
  const auto first = decode(records[0], {.format = Format::position, .group = true});
  const auto second =
      decode(records[1], {.format = Format::position_quaternion, .button = true, .group = true});
  ASSERT_TRUE(first && second);
  EXPECT_NEAR(first->position->y(), 0.2, 2e-4) << "front: x is not negative";
  EXPECT_NEAR(second->position->y(), -0.2, 2e-4) << "left: what is on the right appears opposite";
  EXPECT_NEAR(second->position->z(), 0.3, 2e-4);
}

TEST(BirdEmulator, TellsErrorsOnceAndInWords) {
  using std::string_literals::operator""s;
  Emulator tracker({});
  EXPECT_EQ(tracker.receive("k"s, ms(0)), "");
  EXPECT_EQ(tracker.receive("O\x0A"s, ms(0)), "\x06"s);
  EXPECT_EQ(error_in_words(6), "it did not understand a command");
  EXPECT_EQ(tracker.receive("O\x0A"s, ms(0)), "\x00"s);
  EXPECT_EQ(error_in_words(0), "no error");
  EXPECT_EQ(error_in_words(200), "an unknown error");
}

// The two bytes are those that the real captures have; their first record is one of format Y.
TEST(BirdWords, ReadTheStatusOfARealTracker) {
  EXPECT_EQ(status_in_words(0xD108), "master, initialised, running, position_angles, point");
  EXPECT_EQ(status_in_words(0x0020), "not initialised, not running, asleep, point");
  EXPECT_EQ(revision_in_words("\x03\x3C"), "3.60");
}

TEST(BirdEmulator, SurvivesRandomCommands) {
  Random random(9);
  Emulator tracker({});
  for (int n = 0; n < 20000; ++n) {
    std::string bytes(random.index(6), '\0');
    for (char& byte : bytes) byte = static_cast<char>(random.bits() & 0xff);
    ASSERT_LT(tracker.receive(bytes, ms(n * 10)).size(), 3000u);
    ASSERT_LE(tracker.measure(some_frame(), ms(n * 10)).size(), 4u);
  }
}

}  // namespace
}  // namespace prehend::glove::bird
