// `prehend audit` of what is no log: it is named, and not waited for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

using ::testing::HasSubstr;

class AuditCommand : public test::CommandTest {
 protected:
  AuditCommand() : CommandTest(test::in_programs("prehend") + " audit") {}
};

TEST_F(AuditCommand, WhatIsNoLogIsNamed) {
  std::filesystem::resize_file(file("huge.jsonl", ""), 300 << 20);  // with holes
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {folder.string(), folder.string() + ": is no file (name a log of the folder"},
           {in("huge.jsonl"), "huge.jsonl: is too large for a log (more than 256 MB)"},
           {in("none.jsonl"), "none.jsonl: cannot be read"}}) {
    const auto answer = run(arguments);
    EXPECT_EQ(answer.code, exit_broken) << arguments;
    EXPECT_THAT(answer.complaint, HasSubstr(says));
  }
}

}  // namespace
}  // namespace prehend
