#include "services/demonstration/files/takes_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/takes/made_takes.hpp"

namespace prehend::demonstration {
namespace {

using testing::Test;

const std::vector<Take>& few() {
  static const auto takes = test::made_takes({.people = 2, .trials = 1, .samples = 3});
  return takes;
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows(1, {""});
  for (const char c : csv) {
    if (c == '\n')
      rows.push_back({""});
    else if (c == ',')
      rows.back().emplace_back();
    else
      rows.back().back() += c;
  }
  rows.pop_back();
  return rows;
}

std::string csv_of(const std::vector<std::vector<std::string>>& rows,
                   const std::string& end = "\n") {
  std::string text;
  for (const auto& row : rows) text += fmt::format("{}{}", fmt::join(row, ","), end);
  return text;
}

void expect_same(const std::vector<Take>& read, double tolerance = 1e-5) {
  ASSERT_EQ(read.size(), few().size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].user, few()[i].user);
    EXPECT_EQ(read[i].label, few()[i].label);
    EXPECT_EQ(read[i].task, "1");
    ASSERT_EQ(read[i].samples.size(), few()[i].samples.size());
    for (std::size_t k = 0; k < read[i].samples.size(); ++k)
      for (std::size_t f = 0; f < 4; ++f)
        EXPECT_LT(
            (read[i].samples[k].p_thumb_tip_W[f] - few()[i].samples[k].p_thumb_tip_W[f]).norm(),
            2 * tolerance);
  }
}

TEST(TakesFile, ReadsWhatWasWritten) {
  const auto takes = parse_takes(test::to_csv(few()), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  expect_same(takes->takes);
  EXPECT_TRUE(takes->complaints.empty());
  EXPECT_NEAR(takes->takes[0].samples[1].hand_speed, few()[0].samples[1].hand_speed, 1e-4);
  EXPECT_EQ(takes->rows, 18U);
}

TEST(TakesFile, OrderOfColumnsLineEndsMarksAndQuotesDoNotMatter) {
  auto rows = cells_of(test::to_csv(few()));
  for (auto& row : rows) {
    std::reverse(row.begin(), row.end());
    row.push_back(row.empty() ? "" : "more");  // a column that nobody asked for
  }
  for (const std::string& text :
       {csv_of(rows, "\r\n"), "\xef\xbb\xbf" + csv_of(rows), csv_of(rows, "\n\n")}) {
    const auto takes = parse_takes(text, "task1.csv", "1");
    ASSERT_TRUE(takes) << takes.error().message();
    expect_same(takes->takes);
  }
  for (std::string& cell : rows[0]) cell = " \"" + cell + "\"";
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::string& cell : rows[i]) cell = " \"" + cell + "\" ";
  const auto quoted = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(quoted) << quoted.error().message();
  expect_same(quoted->takes);
}

TEST(TakesFile, OptionalColumnsMayBeMissing) {
  auto rows = cells_of(test::to_csv(few()));
  for (auto& row : rows) {
    row.erase(row.begin() + 7, row.begin() + 9);  // speeds
    row.erase(row.begin() + 3, row.begin() + 5);  // side, action
    row.erase(row.begin() + 1);                   // task
  }
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  expect_same(takes->takes);
  EXPECT_TRUE(takes->complaints.empty());
  EXPECT_TRUE(std::isnan(takes->takes[0].samples[0].hand_speed));
}

TEST(TakesFile, ANeededColumnIsNamed) {
  auto rows = cells_of(test::to_csv(few()));
  rows[0][10] = "thumb_index_height_cm";
  const auto takes = parse_takes(csv_of(rows), "here/task1.csv", "1");
  ASSERT_FALSE(takes);
  EXPECT_EQ(takes.error().where, "here/task1.csv");
  EXPECT_NE(takes.error().what.find("thumb_index_y_cm"), std::string::npos)
      << takes.error().message();
  EXPECT_FALSE(takes.error().hint.empty());
}

TEST(TakesFile, BadRowsAreCountedAndTheOthersStay) {
  auto rows = cells_of(test::to_csv(few()));
  rows[2][6] = "soon";                                                              // no time
  rows[3][0] = "";                                                                  // nobody
  rows[5].resize(4);                                                                // cut
  rows[7][9] = "NaN", rows[8][10] = "inf", rows[9][7] = "-", rows[10][11] = "1e9";  // unknown
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  EXPECT_EQ(takes->bad_rows, 3U);
  EXPECT_EQ(takes->unknown_numbers, 4U);
  EXPECT_EQ(takes->takes.size(), few().size()) << "no take is lost";
  ASSERT_EQ(takes->complaints.size(), 1U) << "one line a file";
  const std::string told = takes->complaints[0].message();
  EXPECT_NE(told.find("3 of 18 rows left out"), std::string::npos) << told;
  EXPECT_NE(told.find("row 2: t_ms is no number"), std::string::npos) << told;
  EXPECT_EQ(told.find('\n'), std::string::npos);
}

TEST(TakesFile, KindAndObjectAreReadWhereTheyAreThere) {
  auto rows = cells_of(test::to_csv(few()));
  const std::vector<std::string> names{"grasp", "shape", "size_x_cm", "size_y_cm", "size_z_cm"};
  rows[0].insert(rows[0].end(), names.begin(), names.end());
  for (std::size_t i = 1; i < rows.size(); ++i)
    rows[i].insert(rows[i].end(), {"tripod", "cylinder", "1.5", "1.5", "12"});
  for (std::size_t i = 1; i <= 3; ++i) rows[i][rows[i].size() - 1] = "-12";     // first take
  for (std::size_t i = 4; i <= 6; ++i) rows[i][rows[i].size() - 5] = "";        // second
  for (std::size_t i = 7; i <= 9; ++i) rows[i][rows[i].size() - 4] = "teapot";  // third
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  ASSERT_EQ(takes->takes.size(), few().size());
  EXPECT_EQ(takes->takes[0].label, "tripod");
  EXPECT_FALSE(takes->takes[0].object) << "no object is lower than nothing";
  EXPECT_EQ(takes->takes[1].label, few()[1].label) << "the object says it";
  EXPECT_FALSE(takes->takes[2].object);
  ASSERT_TRUE(takes->takes[3].object);
  EXPECT_EQ(takes->takes[3].object->kind, model::ShapeKind::cylinder);
  EXPECT_NEAR(takes->takes[3].object->size.z(), 0.12, 1e-9);
}

TEST(TakesFile, TheHandIsReadWhereItIsThere) {
  auto rows = cells_of(test::to_csv(few()));
  const std::vector<std::string> names{"hand_scale", "hand_index_x_cm", "hand_index_z_cm"};
  rows[0].insert(rows[0].end(), names.begin(), names.end());
  for (std::size_t i = 1; i < rows.size(); ++i)
    rows[i].insert(rows[i].end(), {"1.1", "12", i == 2 ? "none" : "-3"});
  rows[1][rows[1].size() - 3] = "-1";
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  const auto& samples = takes->takes[0].samples;
  EXPECT_NEAR(samples[0].p_HF[1].x(), 0.12, 1e-9);
  EXPECT_NEAR(samples[0].p_HF[1].z(), -0.03, 1e-9);
  EXPECT_TRUE(std::isnan(samples[0].p_HF[1].y())) << "no such column";
  EXPECT_TRUE(std::isnan(samples[0].p_HF[0].x()));
  EXPECT_TRUE(std::isnan(samples[0].scale)) << "no hand is shorter than nothing";
  EXPECT_NEAR(samples[1].scale, 1.1, 1e-9);
  EXPECT_TRUE(std::isnan(samples[1].p_HF[1].z()));
  EXPECT_EQ(takes->unknown_numbers, 1U);
}

TEST(TakesFile, SamplesAreInOrderOfTime) {
  auto rows = cells_of(test::to_csv(few()));
  std::swap(rows[1], rows[3]);
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes);
  expect_same(takes->takes);
}

TEST(TakesFile, EmptyBinaryAndNoRows) {
  for (const std::string& text : {std::string(), std::string("\n\n"), std::string(1000, '\0'),
                                  std::string("\xff\xfe,,\x01"), test::to_csv({})}) {
    const auto takes = parse_takes(text, "task1.csv", "1");
    ASSERT_FALSE(takes);
    EXPECT_FALSE(takes.error().hint.empty());
    EXPECT_EQ(takes.error().message().find('\n'), std::string::npos);
  }
}

// Tables as other programs save them were told to lack sixteen columns.
TEST(TakesFile, AnotherFormatIsNamed) {
  const std::string csv = test::to_csv(few());
  const auto with = [&](char from, char to) {
    std::string text = csv;
    std::replace(text.begin(), text.end(), from, to);
    return text;
  };
  std::string wide = "\xff\xfe";
  for (const char c : csv) wide += {c, '\0'};
  for (const auto& [text, what] :
       {std::pair(with(',', ';'), "between its columns"), std::pair(with(',', '\t'), "tabs"),
        std::pair(with('\n', '\r'), "CR alone"), std::pair(wide, "UTF-16")}) {
    const auto takes = parse_takes(text, "task1.csv", "1");
    ASSERT_FALSE(takes) << what;
    EXPECT_NE(takes.error().what.find(what), std::string::npos) << takes.error().message();
    EXPECT_NE(takes.error().hint.find("save it"), std::string::npos);
  }
}

// Fingertips in metres were recognised without a word, at chance.
TEST(TakesFile, ADistanceInAnotherUnitIsTold) {
  const auto scaled = [](double by) {
    auto rows = cells_of(test::to_csv(few()));
    for (std::size_t i = 1; i < rows.size(); ++i)
      for (std::size_t k = 9; k < rows[i].size(); ++k)
        rows[i][k] = fmt::format("{}", by * std::stod(rows[i][k]));
    return parse_takes(csv_of(rows), "task1.csv", "1");
  };
  const auto metres = scaled(0.01), millimetres = scaled(10);
  ASSERT_TRUE(metres);
  ASSERT_EQ(metres->complaints.size(), 1U);
  EXPECT_NE(metres->complaints[0].what.find("are these metres?"), std::string::npos);
  const std::string told =
      (millimetres ? millimetres->complaints[0] : millimetres.error()).message();
  EXPECT_NE(told.find("millimetres"), std::string::npos) << told;
}

// Stamps that count from 1970, and names that begin with a capital letter, were refused.
TEST(TakesFile, TimesMayCountFrom1970AndNamesBeCapital) {
  auto rows = cells_of(test::to_csv(few()));
  for (std::string& name : rows[0]) name[0] = static_cast<char>(std::toupper(name[0]));
  for (std::size_t i = 1; i < rows.size(); ++i)
    rows[i][6] = fmt::format("{:.1f}", 1.7e12 + std::stod(rows[i][6]));
  const auto takes = parse_takes(csv_of(rows), "task1.csv", "1");
  ASSERT_TRUE(takes) << takes.error().message();
  expect_same(takes->takes);
  EXPECT_TRUE(takes->complaints.empty());
}

// A file a person is how studies are kept: each was taken for a task of its own.
TEST(TakesFile, PeopleMayHaveFilesOfTheirOwn) {
  auto rows = cells_of(test::to_csv(few()));
  for (auto& row : rows) row.erase(row.begin() + 1);  // task
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("people" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  for (const char* name : {"task1_anna.csv", "Task1-ben.CSV", "task1.csv"})
    std::ofstream(folder / name) << csv_of(rows);
  std::ofstream(folder / "task_kinds.csv") << csv_of(rows);
  const auto takes = load_takes(folder);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(takes) << takes.error().message();
  std::map<std::string, std::size_t> tasks;
  for (const Take& take : takes->takes) ++tasks[take.task];
  EXPECT_EQ(tasks, (std::map<std::string, std::size_t>{{"1", 3 * few().size()},
                                                       {"_kinds", few().size()}}));
}

TEST(TakesFile, OneBadFileDoesNotCostTheOthers) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("takes" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "task9.csv");  // a folder in place of a file
  std::ofstream(folder / "task1.csv") << test::to_csv(few());
  std::ofstream(folder / "task2.csv") << "nothing of use";
  std::ofstream(folder / "notes.txt") << "not asked for";
  const auto takes = load_takes(folder);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(takes) << takes.error().message();
  expect_same(takes->takes);
  EXPECT_EQ(takes->files, 3U);
  EXPECT_EQ(takes->bad_files, 2U);
  EXPECT_EQ(takes->complaints.size(), 2U);
  EXPECT_FALSE(load_takes(folder)) << "it is gone";
}

}  // namespace
}  // namespace prehend::demonstration
