// The tracker's records: round trips over all formats, garbage, and finding the place again.
#include "services/glove/devices/bird_protocol.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "common/base/pose.hpp"
#include "common/base/random.hpp"

namespace prehend::glove::bird {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d random_rotation(Random& random) {
  const Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return q.normalized().toRotationMatrix();
}

Layout layout_of(Format format, bool button, bool group, double range) {
  return {.format = format, .button = button, .group = group, .range = range};
}

// A word keeps 14 bits: half a step is 2/32768 of full scale, so 0.11 mm at 72 inches (0.22 at
// 144), and 0.0002 rad in angles; an element of a matrix or quaternion is off by 6e-5, and 1
// becomes 0.99988.
TEST(BirdProtocol, RoundTripsEveryFormat) {
  Random random(2);
  for (const FormatInfo& entry : formats)
    for (const double range : {short_range, long_range, extended_scale})
      for (const bool button : {false, true})
        for (const bool group : {false, true})
          for (int n = 0; n < 50; ++n) {
            const Layout layout = layout_of(entry.format, button, group, range);
            const Vector3d p(random.uniform(-0.99, 0.99) * range,
                             random.uniform(-0.99, 0.99) * range,
                             random.uniform(-0.99, 0.99) * range);
            const Matrix3d R = random_rotation(random);
            const std::string bytes = encode(p, R, layout, 3, 5);
            ASSERT_EQ(bytes.size(), layout.length());
            const auto record = decode(bytes, layout);
            ASSERT_TRUE(record) << entry.name;
            if (record->position) {
              EXPECT_LT((*record->position - p).cwiseAbs().maxCoeff(), 2.01 / 32768 * range);
            }
            if (const auto got = record->rotation()) {
              EXPECT_LT(angle_between(*got, R), 6e-4) << entry.name;
            } else {
              EXPECT_EQ(entry.format, Format::position);
            }
            EXPECT_EQ(record->button.has_value(), button);
            EXPECT_EQ(record->address.has_value(), group);
            EXPECT_EQ(record->button.value_or(5), 5);
            EXPECT_EQ(record->address.value_or(3), 3);
          }
}

TEST(BirdProtocol, HasTheDocumentedLengths) {
  const std::map<char, std::size_t> lengths{{'V', 6},  {'W', 6},  {'X', 18}, {'\\', 8},
                                            {'Y', 12}, {'Z', 24}, {']', 14}};
  for (const auto& [command, length] : lengths)
    EXPECT_EQ(info(*format_of_command(command)).length, length) << command;
  EXPECT_FALSE(format_of_command('B'));
}

TEST(BirdProtocol, ClampsPositionsBeyondTheRange) {
  const Layout layout = layout_of(Format::position, false, false, short_range);
  const auto record = decode(encode({5, -5, 0}, Matrix3d::Identity(), layout), layout);
  ASSERT_TRUE(record);
  EXPECT_NEAR(record->position->x(), short_range, 1e-3);
  EXPECT_NEAR(record->position->y(), -short_range, 1e-3);
}

TEST(BirdProtocol, RefusesWrongPhasesAndLengths) {
  const Layout layout = layout_of(Format::position_matrix, false, true, long_range);
  const std::string good = encode({0.1, 0.2, 0.3}, Matrix3d::Identity(), layout);
  ASSERT_TRUE(decode(good, layout));
  EXPECT_FALSE(decode(good.substr(1), layout));
  EXPECT_FALSE(decode("", layout));
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x80);
    EXPECT_FALSE(decode(bad, layout)) << i;
  }
}

// Whatever byte is lost or foreign bytes come in between, the record after the next is whole.
TEST(BirdProtocol, FindsItsPlaceWithinTwoRecords) {
  Random random(4);
  for (const FormatInfo& entry : formats)
    for (int n = 0; n < 200; ++n) {
      const Layout layout = layout_of(entry.format, n % 2 == 0, n % 3 == 0, long_range);
      const auto whole = [&](int address) {
        return encode({0.1, 0.2, 0.3}, Matrix3d::Identity(), layout, address);
      };
      std::string damaged = whole(1);
      if (random.uniform() < 0.5) {
        damaged.erase(random.index(damaged.size()), 1);
      } else {
        for (std::size_t k = 1 + random.index(40); k > 0; --k)
          damaged.insert(damaged.begin() + static_cast<long>(random.index(damaged.size() + 1)),
                         static_cast<char>(random.bits() & 0xff));
      }
      RecordParser parser(layout);
      parser.feed(whole(1) + damaged);
      parser.feed(whole(2));
      const auto records = parser.feed(whole(3));
      ASSERT_EQ(records.size(), 1u) << entry.name;
      if (records[0].position) {
        EXPECT_LT((*records[0].position - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-3);
      }
    }
}

TEST(BirdProtocol, CutsAStreamIntoRecordsHoweverItArrives) {
  const Layout layout = layout_of(Format::position_quaternion, false, true, long_range);
  std::string stream;
  for (int n = 0; n < 40; ++n)
    stream += encode({0.01 * n, 0, 0}, Matrix3d::Identity(), layout, n % 4 + 1);
  Random random(8);
  for (int round = 0; round < 20; ++round) {
    RecordParser parser(layout);
    std::size_t at = 0, count = 0;
    while (at < stream.size()) {
      const std::size_t size = std::min(stream.size() - at, 1 + random.index(30));
      for (const Record& record : parser.feed(std::string_view(stream).substr(at, size))) {
        EXPECT_EQ(*record.address, static_cast<int>(count) % 4 + 1);
        ++count;
      }
      at += size;
    }
    EXPECT_EQ(count, 40u);
    EXPECT_EQ(parser.garbage(), 0u);
  }
}

// Random bytes: records may come out, but finite and in range, and every byte is accounted for.
TEST(BirdProtocol, SurvivesRandomBytes) {
  Random random(6);
  for (const FormatInfo& entry : formats) {
    const Layout layout = layout_of(entry.format, true, true, long_range);
    RecordParser parser(layout);
    std::size_t fed = 0, records = 0;
    for (int n = 0; n < 2000; ++n) {
      std::string bytes(random.index(60), '\0');
      for (char& byte : bytes) byte = static_cast<char>(random.bits() & (n % 2 ? 0xff : 0x7f));
      fed += bytes.size();
      for (const Record& record : parser.feed(bytes)) {
        ++records;
        if (record.position) {
          ASSERT_LE(record.position->cwiseAbs().maxCoeff(), long_range);
        }
        if (const auto R = record.rotation()) {
          ASSERT_LT((*R * R->transpose() - Matrix3d::Identity()).norm(), 1e-9);
        }
      }
    }
    EXPECT_EQ(fed, records * layout.length() + parser.garbage() + parser.pending());
  }
}

TEST(BirdProtocol, KnowsTheCodesOfItsMouse) {
  for (const std::vector<std::uint8_t>& held :
       {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>{1}, std::vector<std::uint8_t>{2},
        std::vector<std::uint8_t>{3}})
    EXPECT_EQ(held_buttons(button_code(held)), held);
  EXPECT_FALSE(held_buttons(0x01));
  EXPECT_FALSE(held_buttons(0x7f)) << "what no mouse says holds nothing";
}

}  // namespace
}  // namespace prehend::glove::bird
