#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "common/base/file_text.hpp"

namespace prehend::test {

/// What a command came to.
struct Answer {
  int code = -1;  // -1: it was killed
  std::string output, complaint;
};

/// Runs shell text; what it says goes through files `out` and `err` of this folder.
inline Answer answer_to(const std::string& text, const std::filesystem::path& folder) {
  const auto out = folder / "out", err = folder / "err";
  const std::string line =
      "(" + text + "\n) >" + out.string() + " 2>" + err.string() + " </dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out).value(),
          read_file(err).value()};
}

/// Calls a command as a user does, in a folder that is the test's own, also for what users keep at
/// home.
class CommandTest : public testing::Test {
 protected:
  /// command: a program's path and perhaps its first arguments.
  explicit CommandTest(std::string command) : command_(std::move(command)) {}
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + test->name());
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// arguments: as typed in a shell.
  Answer run(const std::string& arguments) const {
    return answer_to("XDG_DATA_HOME=" + in("data") + " " + command_ + " " + arguments, folder);
  }

  std::string in(const std::string& name) const { return (folder / name).string(); }
  /// Writes a file there.
  std::string file(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file(folder / name, text));
    return in(name);
  }

  std::filesystem::path folder;

 private:
  std::string command_;
};

}  // namespace prehend::test
