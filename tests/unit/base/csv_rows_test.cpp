// Tables written by this test come back cell by cell: numbers exactly, since the shortest text of a
// double reads back as the same double.
#include "common/base/csv_rows.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/base/random.hpp"

namespace prehend {
namespace {

TEST(CsvRows, GiveBackWhatWasWritten) {
  Random random(1);
  for (const std::string_view end : {"\n", "\r\n"}) {
    std::vector<Eigen::Vector3d> written;
    std::string text = fmt::format("p_z,name,p_x,p_y{}", end);
    for (int i = 0; i < 200; ++i) {
      written.push_back(random.normal3(std::pow(10, random.uniform(-9, 9))));
      const Eigen::Vector3d& p = written.back();
      text += fmt::format("{},row {},{},{}{}", p.z(), i, p.x(), p.y(), end);
      if (i % 7 == 0) text += end;  // an empty line is no row
    }
    CsvRows rows(text);
    EXPECT_TRUE(rows.has("p_z") && rows.has("name") && rows.has("p_x") && rows.has("p_y"));
    EXPECT_FALSE(rows.has("p"));
    for (std::size_t i = 0; i < written.size(); ++i) {
      auto row = rows.next();
      ASSERT_TRUE(row);
      EXPECT_EQ(row->vector("p"), written[i]);
      EXPECT_EQ(row->text("name"), fmt::format("row {}", i));
      EXPECT_FALSE(row->bad());
    }
    EXPECT_FALSE(rows.next());
  }
}

TEST(CsvRows, AreBadWhereSomethingIsMissingOrUnreadable) {
  const auto is_bad = [](std::string_view cells, std::string_view column) {
    const std::string text = fmt::format("a,b\n{}\n", cells);
    CsvRows rows(text);
    auto row = rows.next();
    if (!row) return true;
    const double read = row->number(column);
    EXPECT_EQ(read == 0, row->bad());
    return row->bad();
  };
  EXPECT_FALSE(is_bad("1,2", "b"));
  EXPECT_FALSE(is_bad("1,-2.5e-3", "b"));
  EXPECT_TRUE(is_bad("1,2", "c")) << "no such column";
  EXPECT_TRUE(is_bad("1", "b")) << "the row is too short";
  EXPECT_TRUE(is_bad("1,", "b")) << "an empty cell";
  EXPECT_TRUE(is_bad("1,2x", "b"));
  EXPECT_TRUE(is_bad("1, 2", "b"));
  EXPECT_TRUE(is_bad("1,nan", "b"));
  EXPECT_TRUE(is_bad("1,inf", "b"));
  EXPECT_TRUE(is_bad("1,1e999", "b"));
}

TEST(CsvRows, OfNothingAreNone) {
  for (const std::string_view text : {"", "\n", "\r\n\r\n", "a,b", "a,b\r\n"})
    EXPECT_FALSE(CsvRows(text).next()) << text;
}

// As spreadsheets write them.
TEST(CsvRows, ReadWhatSpreadsheetsMakeOfThem) {
  for (const std::string_view text :
       {"\xef\xbb\xbf"
        "a,B,name\r\n1.5,-2,x\r\n",
        "A;b;Name\n1,5;-2;x\n", "a\tb\tNAME\n1,5\t-2\tx\n", "a, b ,name\n1.5,-2,x",
        "\"a\",\"b\",\"name\"\n\"1.5\",-2,\"x\"\n"}) {
    CsvRows rows(text);
    auto row = rows.next();
    ASSERT_TRUE(row) << text;
    EXPECT_EQ(row->number("a"), 1.5) << text;
    EXPECT_EQ(row->number("b"), -2) << text;
    EXPECT_EQ(row->text("name"), "x") << text;
    EXPECT_FALSE(row->bad()) << text;
    EXPECT_EQ(row->line(), 2u);
    EXPECT_FALSE(rows.next());
  }
  CsvRows quoted("a,b\n\"x, y\",\"z\n\n\"q\"r,2\n");
  auto row = quoted.next();
  EXPECT_EQ(row->text("a"), "x, y");
  EXPECT_EQ(row->text("b"), "\"z");  // without its other quote
  row = quoted.next();
  EXPECT_EQ(row->text("a"), "\"q\"r");
  EXPECT_EQ(row->line(), 4u);
}

// An empty cell at the end of a line is a cell.
TEST(CsvRows, CountEmptyCells) {
  CsvRows rows("a,b,c\n,,\n1,,\n");
  for (const std::string_view first : {"", "1"}) {
    auto row = rows.next();
    ASSERT_TRUE(row);
    EXPECT_EQ(row->text("a"), first);
    EXPECT_EQ(row->text("b"), "");
    EXPECT_EQ(row->text("c"), "");
    EXPECT_FALSE(row->bad());
  }
}

}  // namespace
}  // namespace prehend
