// Samples of a joint-angle glove: whatever happens on the line, the next 0 ends it, so at most two
// records are lost by one fault.
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "services/glove/devices/joint_emulator.hpp"

namespace prehend::glove::joint {
namespace {

using std::string_literals::operator""s;

Counts random_counts(Random& random, std::size_t sensors) {
  Counts counts(sensors);
  for (auto& count : counts) count = static_cast<std::uint8_t>(1 + random.index(255));
  return counts;
}

TEST(JointProtocol, RoundTripsHoweverItArrives) {
  Random random(1);
  for (const std::size_t sensors : {18u, 22u}) {
    std::vector<Counts> sent;
    std::string stream;
    for (int n = 0; n < 50; ++n) {
      sent.push_back(random_counts(random, sensors));
      stream += encode(sent.back(), n % 2 == 0 ? 'S' : 'G');
    }
    for (int round = 0; round < 20; ++round) {
      RecordParser parser(sensors);
      std::vector<Counts> got;
      for (std::size_t at = 0; at < stream.size();) {
        const std::size_t size = std::min(stream.size() - at, 1 + random.index(40));
        for (Counts& counts : parser.feed(std::string_view(stream).substr(at, size)))
          got.push_back(std::move(counts));
        at += size;
      }
      EXPECT_EQ(got, sent);
      EXPECT_EQ(parser.garbage() + parser.pending(), 0u);
    }
  }
}

TEST(JointProtocol, FindsItsPlaceWithinTwoRecords) {
  Random random(2);
  for (int n = 0; n < 2000; ++n) {
    const Counts counts = random_counts(random, 22);
    std::string damaged = encode(counts);
    if (random.uniform() < 0.5)
      damaged.erase(random.index(damaged.size()), 1 + random.index(30));
    else
      for (std::size_t k = 1 + random.index(60); k > 0; --k)
        damaged.insert(damaged.begin() + static_cast<long>(random.index(damaged.size() + 1)),
                       static_cast<char>(random.bits() & 0xff));
    RecordParser parser(22);
    parser.feed(encode(counts) + damaged);
    parser.feed(encode(counts));
    const auto records = parser.feed(encode(counts));
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0], counts);
  }
}

TEST(JointProtocol, AccountsForEveryByte) {
  Random random(3);
  RecordParser parser(18);
  std::size_t fed = 0, records = 0;
  for (int n = 0; n < 20000; ++n) {
    std::string bytes(random.index(40), '\0');
    for (char& byte : bytes)
      byte = random.uniform() < 0.05 ? '\0' : static_cast<char>(random.bits() & 0xff);
    fed += bytes.size();
    for (const Counts& counts : parser.feed(bytes)) {
      ++records;
      ASSERT_EQ(counts.size(), 18u);
      for (const auto count : counts) ASSERT_GE(count, 1);
    }
  }
  EXPECT_EQ(fed, records * 20 + parser.garbage() + parser.pending());
}

TEST(JointProtocol, WritesPeriodsAndReadsAnswers) {
  EXPECT_EQ(period_command(100), "t 1152 1\r");
  EXPECT_EQ(period_command(1), "t 57600 2\r");
  EXPECT_EQ(answered('S', "?S\x16\0"s), 22);
  EXPECT_EQ(answered('S', "noise?S\x12\0"s), 18);
  EXPECT_FALSE(answered('S', "?S\x16"s));
  EXPECT_FALSE(answered('S', "?R\x01\0"s));
  EXPECT_FALSE(answered('S', ""));
}

Duration ms(int n) {
  return std::chrono::milliseconds(n);
}

TEST(JointEmulator, SpeaksTheProtocol) {
  Emulator glove({.gains = *typical_gains(18)});
  EXPECT_EQ(glove.receive("?S"s, ms(0)), "?S\x12\0"s);
  EXPECT_EQ(glove.receive("?R"s, ms(0)), "?R\x01\0"s);
  EXPECT_EQ(glove.receive("?"s, ms(0)), "") << "a command in pieces";
  EXPECT_EQ(glove.receive("N"s, ms(0)), "?N\x12\0"s);
  EXPECT_EQ(glove.receive("!"s, ms(0)), "e?\0"s);
  EXPECT_EQ(glove.receive("t x\r"s, ms(0)), "e?\0"s);
  EXPECT_EQ(glove.receive("t 1152 2\r"s, ms(0)), "t 1152 2\r\n\0"s);
  const Frame frame{.joint_angles = std::vector<double>(20, 0.1)};
  EXPECT_TRUE(glove.measure(frame, ms(0)).empty());
  EXPECT_EQ(glove.receive("G"s, ms(0)).size(), 20u);
  glove.receive("S"s, ms(0));
  int samples = 0;
  for (int n = 0; n < 100; ++n) samples += static_cast<int>(glove.measure(frame, ms(n * 5)).size());
  EXPECT_NEAR(samples, 25, 1) << "one each 20 ms";
  glove.receive("\x03"s, ms(500));
  EXPECT_TRUE(glove.measure(frame, ms(1000)).empty());
}

TEST(JointEmulator, SurvivesRandomCommands) {
  Random random(9);
  Emulator glove({.gains = *typical_gains(22)});
  for (int n = 0; n < 20000; ++n) {
    std::string bytes(random.index(12), '\0');
    for (char& byte : bytes) byte = static_cast<char>(random.bits() & 0xff);
    ASSERT_LT(glove.receive(bytes, ms(n)).size(), 600u);
    ASSERT_LE(glove.measure({.joint_angles = std::vector<double>(20, 0.1)}, ms(n)).size(), 1u);
  }
}

}  // namespace
}  // namespace prehend::glove::joint
