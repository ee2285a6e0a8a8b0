// Lines there and back, what is no line, files that follow each other, and refusals that come a
// thousand times and are a few lines.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "common/audit/log.hpp"

namespace prehend::audit {
namespace {

const Time start = from_ns(1'700'000'000'123'000'000);

class Audit : public testing::Test {
 protected:
  Audit() {
    folder_ =
        std::filesystem::temp_directory_path() / ("prehend-audit-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
  }
  ~Audit() override { std::filesystem::remove_all(folder_); }
  Log open(std::uintmax_t max_bytes = 1 << 20, int max_files = 16) {
    return std::move(*Log::open(
        {.folder = folder_, .name = "hand", .max_bytes = max_bytes, .max_files = max_files}));
  }
  std::vector<Record> read(const std::string& file) {
    std::vector<Record> records;
    std::ifstream stream(folder_ / file);
    for (std::string line; std::getline(stream, line);) {
      const auto record = parse(line);
      EXPECT_TRUE(record) << line;
      if (record) records.push_back(*record);
    }
    return records;
  }
  std::filesystem::path folder_;
};

TEST_F(Audit, LinesSayWhatTheRecordSays) {
  const Record record{start, "hand", Event::stop, "anna \"a\"\n", "a child\tcame in, ü", 3};
  const std::string line = to_line(record);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_NE(line.find("2023-11-14T22:13:20.123Z"), std::string::npos) << line;
  const auto again = parse(line);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->time, start);
  EXPECT_EQ(again->hand, record.hand);
  EXPECT_EQ(again->event, Event::stop);
  EXPECT_EQ(again->who, record.who);
  EXPECT_EQ(again->what, record.what);
  EXPECT_EQ(again->count, 3u);
}

TEST_F(Audit, WhatIsNoLineIsRefused) {
  for (const char* line :
       {"", "{", "[]", "7", R"({"event":"stop"})", R"({"stamp_ns":"1","event":"stop"})",
        R"({"stamp_ns":1,"event":"dance"})", R"({"stamp_ns":1})", R"({"stamp_ns":1,"event":7})",
        R"({"stamp_ns":1,"event":"stop","who":[]})", R"({"stamp_ns":1,"event":"stop","count":-1})",
        R"({"stamp_ns":1.5,"event":"stop"})"})
    EXPECT_FALSE(parse(line)) << line;
  EXPECT_FALSE(parse(std::string(1 << 20, '[')));
  EXPECT_TRUE(parse(R"({"stamp_ns":1,"event":"stop","new":{"x":1}})"));
}

TEST_F(Audit, FilesFollowEachOtherAndTheOldestGo) {
  {
    Log log = open(2000, 3);
    for (std::uint64_t i = 0; i < 200; ++i)
      EXPECT_TRUE(log.write({start, "hand", Event::order_refused, "anna", std::to_string(i)}));
  }
  const auto newest = read("hand.jsonl"), before = read("hand.1.jsonl"),
             oldest = read("hand.2.jsonl");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "hand.3.jsonl"));
  ASSERT_FALSE(newest.empty() || before.empty() || oldest.empty());
  EXPECT_EQ(newest.back().what, "199");
  EXPECT_EQ(std::stoi(newest.front().what), std::stoi(before.back().what) + 1);
  EXPECT_EQ(std::stoi(before.front().what), std::stoi(oldest.back().what) + 1);
  for (const char* file : {"hand.jsonl", "hand.1.jsonl", "hand.2.jsonl"})
    EXPECT_LE(std::filesystem::file_size(folder_ / file), 2000u);
  // What is there is gone on with.
  {
    Log log = open();
    EXPECT_TRUE(log.write({start, "hand", Event::begin, "", ""}));
  }
  EXPECT_EQ(read("hand.jsonl").size(), newest.size() + 1);
}

TEST_F(Audit, RefusalsAreTheFirstAndThenTheirNumber) {
  Log log = open();
  for (int ms = 0; ms < 25'000; ms += 10) {
    const Time now = start + std::chrono::milliseconds(ms);
    log.refuse({now, "hand", Event::refused, "mapping@a/1", "command too old"});
    if (ms == 0) log.refuse({now, "hand", Event::refused, "mapping@a/2", "command too old"});
    log.flush(now);
  }
  log.flush(start + std::chrono::seconds(25), true);
  std::uint64_t of_one = 0, lines = 0;
  for (const Record& record : read("hand.jsonl")) {
    ++lines;
    if (record.who == "mapping@a/1") of_one += record.count;
  }
  EXPECT_EQ(of_one, 2500u);
  EXPECT_EQ(lines, 5u);  // two first ones, after 10 s, after 20 s, at the end
}

TEST_F(Audit, CannotBeOpenedWhereAFileIs) {
  std::filesystem::create_directories(folder_.parent_path());
  std::ofstream(folder_) << "no folder";
  EXPECT_FALSE(Log::open({.folder = folder_, .name = "hand"}));
}

// It would wait for who reads it, for ever, in the process that moves the hand.
TEST_F(Audit, DoesNotWaitForThePipeThatIsInItsPlace) {
  std::filesystem::create_directories(folder_);
  ASSERT_EQ(::mkfifo((folder_ / "hand.jsonl").c_str(), 0600), 0);
  EXPECT_FALSE(Log::open({.folder = folder_, .name = "hand"}));
}

TEST_F(Audit, DoesNotWriteThroughALink) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "other") << "mine";
  std::filesystem::create_symlink(folder_ / "other", folder_ / "hand.jsonl");
  EXPECT_FALSE(Log::open({.folder = folder_, .name = "hand"}));
  EXPECT_EQ(std::filesystem::file_size(folder_ / "other"), 4u);
  std::filesystem::remove(folder_ / "hand.jsonl");
  std::filesystem::create_symlink(folder_ / "none", folder_ / "hand.jsonl");
  EXPECT_FALSE(Log::open({.folder = folder_, .name = "hand"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

// A disk that was full, or a loss of power, leaves half a line.
TEST_F(Audit, HalfALineDoesNotTakeTheNextOneWithIt) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "hand.jsonl")
      << to_line({start, "hand", Event::begin, "", ""}) << "\n{\"stamp_ns\":17";
  {
    Log log = open();
    EXPECT_TRUE(log.write({start, "hand", Event::stop, "anna", "1"}));
    EXPECT_TRUE(log.write({start, "hand", Event::stop, "anna", "2"}));
  }
  std::ifstream stream(folder_ / "hand.jsonl");
  std::vector<std::string> good;
  int damaged = 0;
  for (std::string line; std::getline(stream, line);) {
    const auto record = parse(line);
    record ? good.push_back(record->what) : void(++damaged);
  }
  EXPECT_EQ(good, (std::vector<std::string>{"", "1", "2"}));
  EXPECT_EQ(damaged, 1);
}

// Somebody has filled it: the next line begins a new one.
TEST_F(Audit, AHugeFileIsPutAside) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "hand.jsonl") << "x";
  std::filesystem::resize_file(folder_ / "hand.jsonl", std::uintmax_t{1} << 40);  // with holes
  Log log = open();
  EXPECT_TRUE(log.write({start, "hand", Event::stop, "anna", ""}));
  EXPECT_LT(std::filesystem::file_size(folder_ / "hand.jsonl"), 4096u);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "hand.1.jsonl"));
}

}  // namespace
}  // namespace prehend::audit
