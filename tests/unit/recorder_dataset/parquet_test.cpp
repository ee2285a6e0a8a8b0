// Bytes of small files, worked out by hand from the format's description:
// https://parquet.apache.org and Thrift's compact protocol. That others read whole files is tested
// in tests/interop/dataset.
#include "services/recorder/core/dataset/parquet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "services/recorder/core/dataset/thrift.hpp"

namespace prehend::recorder::dataset {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::ElementsAre;

bool contains(const Bytes& file, const Bytes& part) {
  return std::ranges::search(file, part).begin() != file.end();
}

TEST(Thrift, NumbersFieldsFromTheOneBefore) {
  ThriftWriter writer;
  writer.integer(1, -1);
  writer.integer(3, 300, true);
  writer.text(20, "ab");
  writer.end();
  EXPECT_THAT(writer.bytes(), ElementsAre(0x15, 0x01,        // +1, i32: zigzag of -1
                                          0x26, 0xd8, 0x04,  // +2, i64: 600 in sevens of bits
                                          0x08, 0x28, 2, 'a', 'b',  // +17 does not fit: 20, zigzag
                                          0x00));
}

TEST(Thrift, StructuresBeginToCountAnew) {
  ThriftWriter writer;
  writer.begin(4);
  writer.integer(1, 0);
  writer.end();
  writer.integer(5, 0);
  writer.end();
  EXPECT_THAT(writer.bytes(), ElementsAre(0x4c, 0x15, 0x00, 0x00, 0x15, 0x00, 0x00));
}

TEST(Thrift, LongListsSayTheirLengthApart) {
  ThriftWriter writer;
  writer.list(1, ThriftWriter::Element::integer, 2);
  writer.element_integer(1);
  writer.element_integer(-2);
  writer.list(2, ThriftWriter::Element::structure, 200);
  EXPECT_THAT(writer.bytes(), ElementsAre(0x19, 0x25, 0x02, 0x03, 0x19, 0xfc, 0xc8, 0x01));
}

TEST(Parquet, EndsWithTheLengthOfItsFooter) {
  const Bytes file = parquet({{"a", {}, std::vector<std::int64_t>{7}}}, 1);
  const std::string text(file.begin(), file.end());
  EXPECT_EQ(text.substr(0, 4), "PAR1");
  EXPECT_EQ(text.substr(text.size() - 4), "PAR1");
  const std::size_t end = file.size() - 8;
  const std::size_t length = file[end] | static_cast<std::size_t>(file[end + 1]) << 8;
  ASSERT_LT(length + 12, file.size());
  EXPECT_EQ(file[end - length], 0x15);  // the footer's first field: its version
  EXPECT_EQ(file[end - 1], 0x00);       // and its end
}

TEST(Parquet, ValuesFollowTheirLevels) {
  const Bytes file = parquet({{"a", {}, std::vector<std::int64_t>{1, -1}}}, 2);
  EXPECT_TRUE(
      contains(file, {2, 0, 0, 0, 0x04, 1,  // two values are there
                      1, 0, 0, 0, 0,    0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}));
}

TEST(Parquet, ListsSayWhereARowBegins) {
  const Bytes file = parquet({{"a", {2}, std::vector<float>{1, 2, 3, 4}}}, 2);
  EXPECT_TRUE(
      contains(file, {2, 0, 0,    0,    0x03, 0x0a,  // 0 1 0 1
                      2, 0, 0,    0,    0x08, 3,     // four values, three levels deep
                      0, 0, 0x80, 0x3f, 0,    0,    0, 0x40, 0, 0, 0x40, 0x40, 0, 0, 0x80, 0x40}));
}

TEST(Parquet, ListsOfLists) {
  const Bytes colours = parquet({{"a", {3, 1, 1}, std::vector<double>{0, 0, 0}}}, 1);
  EXPECT_TRUE(contains(colours, {3, 0, 0, 0, 0x03, 0x14, 0x00,  // 0 1 1, two bits each
                                 2, 0, 0, 0, 0x06, 7}));
  const Bytes table = parquet({{"a", {2, 3}, std::vector<double>(6)}}, 1);
  EXPECT_TRUE(contains(table, {3, 0, 0, 0, 0x03, 0x68, 0x0a,  // 0 2 2 1 2 2
                               2, 0, 0, 0, 0x0c, 5}));
}

TEST(Parquet, TruthIsBits) {
  std::vector<bool> values(10);
  values[0] = values[3] = values[9] = true;
  const Bytes file = parquet({{"a", {}, values}}, 10);
  EXPECT_TRUE(contains(file, {2, 0, 0, 0, 0x14, 1, 0x09, 0x02}));
}

TEST(Parquet, TextSaysItsLength) {
  const Bytes file = parquet({{"a", {}, std::vector<std::string>{"ab", ""}}}, 2, {{"k", "v"}});
  EXPECT_TRUE(contains(file, {2, 0, 0, 0, 0x04, 1, 2, 0, 0, 0, 'a', 'b', 0, 0, 0, 0}));
  EXPECT_TRUE(contains(file, {0x18, 1, 'k', 0x18, 1, 'v', 0x00}));  // of the whole file
}

}  // namespace
}  // namespace prehend::recorder::dataset
