// `prehend keys add` and `show`: for which rig a key is made is said, and columns stay apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

using ::testing::HasSubstr;

class Keys : public test::CommandTest {
 protected:
  Keys() : CommandTest(test::in_programs("prehend") + " keys") {}
};

// Guards a store for any rig, in which a key for the rig of lab.toml was made, unsaid.
TEST_F(Keys, AddSaysForWhichRig) {
  ASSERT_EQ(run("init " + in("keys") + " --rig any").code, 0);
  const auto lab = run("add viewer-anna --store " + in("keys"));
  EXPECT_EQ(lab.code, 0) << lab.complaint;
  EXPECT_THAT(lab.complaint, HasSubstr("made viewer-anna for rig lab"));
  EXPECT_THAT(lab.complaint, HasSubstr("--rig chooses another"));
  const auto any = run("add viewer-berta --rig any --store " + in("keys"));
  EXPECT_THAT(any.complaint, HasSubstr("made viewer-berta for any rig"));
}

TEST_F(Keys, ShowKeepsItsColumnsApart) {
  ASSERT_EQ(run("init " + in("keys") + " --rig a-rig-with-a-long-name").code, 0);
  ASSERT_EQ(run("add viewer-a-long-name-too --rig another --store " + in("keys")).code, 0);
  const auto shown = run("show --store " + in("keys"));
  EXPECT_EQ(shown.code, 0) << shown.complaint;
  const std::regex row(
      "viewer-a-long-name-too +viewer +valid +[0-9-]{10} +rig another.* writes .*");
  EXPECT_TRUE(std::regex_search(shown.output, row)) << shown.output;
}

}  // namespace
}  // namespace prehend
