// Files are read and written whole, and what fails is a value: an ifstream's iterators throw where
// a read fails, which ended programs that were given a folder.
#include "common/base/file_text.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

namespace prehend {
namespace {

class FileText : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("file-text-" + std::to_string(::getpid()));
};

TEST_F(FileText, ComesBackByteForByte) {
  std::string content(200'000, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * 31 % 256);
  ASSERT_TRUE(write_file(folder_ / "bytes", content));
  EXPECT_EQ(read_file(folder_ / "bytes").value(), content);
  ASSERT_TRUE(write_file(folder_ / "bytes", ""));
  EXPECT_EQ(read_file(folder_ / "bytes").value(), "");
}

TEST_F(FileText, WhatCannotBeReadIsSaidWithItsReason) {
  EXPECT_EQ(
      read_file(folder_ / "none", "try another").error().message(),
      (folder_ / "none").string() + ": cannot be read: No such file or directory (try another)");
  EXPECT_EQ(read_file(folder_).error().what, "cannot be read: Is a directory");
}

TEST_F(FileText, WhatCannotBeWrittenLeavesTheOldFileAndNothingBeside) {
  EXPECT_EQ(write_file(folder_ / "none" / "file", "x").error().what,
            "cannot be written: No such file or directory");
  std::filesystem::create_directories(folder_ / "taken" / "by a folder");
  EXPECT_FALSE(write_file(folder_ / "taken", "x"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(FileText, ReadersNeverSeeHalf) {
  const std::string one(100'000, '1'), two(300'000, '2');
  ASSERT_TRUE(write_file(folder_ / "file", one));
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (int i = 0; i < 200; ++i) (void)write_file(folder_ / "file", i % 2 == 0 ? two : one);
    done = true;
  });
  while (!done) {
    const auto seen = read_file(folder_ / "file");
    EXPECT_TRUE(seen && (*seen == one || *seen == two));
  }
  writer.join();
}

}  // namespace
}  // namespace prehend
