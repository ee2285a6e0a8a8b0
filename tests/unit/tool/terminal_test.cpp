// Nothing that somebody else has named commands the terminal: what is printed for people goes
// through one function. This reads the sources, so that a new command is held to it, too.
#include "common/base/terminal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "common/base/to_terminal.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

TEST(Terminal, NamesOfOthersCannotCommandIt) {
  ::testing::internal::CaptureStdout();
  to_terminal("{:4} {}\n", "\x1b[2J", "µ\x07");
  std::fflush(stdout);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "\\x1b[2J µ\\x07\n");
}

// Editors say by TERM=dumb that their terminal has no cursor that could be moved.
TEST(Terminal, ADumbOneGetsNoCursorEscapes) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master) | ::unlockpt(master), 0);
  const int terminal = ::open(::ptsname(master), O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ::setenv("TERM", "xterm", 1);
  EXPECT_TRUE(has_cursor(terminal));
  ::setenv("TERM", "dumb", 1);
  EXPECT_FALSE(has_cursor(terminal));
  ::close(terminal);
  ::close(master);
}

TEST(Terminal, WhatIsPrintedForPeopleGoesThroughOneFunction) {
  static const std::regex by_itself("fmt::print\\((?!\\s*stderr)|\\bprintf\\(|std::puts");
  std::size_t sources = 0;
  for (const char* part : {"common", "services"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(test::in_sources(part))) {
      const auto kind = entry.path().extension();
      if (kind != ".cpp" && kind != ".hpp") continue;
      ++sources;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      EXPECT_FALSE(std::regex_search(text.str(), by_itself))
          << entry.path() << ": use common/base/to_terminal.hpp";
    }
  EXPECT_GT(sources, 500u);
}

}  // namespace
}  // namespace prehend
