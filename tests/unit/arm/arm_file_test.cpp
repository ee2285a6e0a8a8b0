// What an arm's two files may say: each wrong one is refused, naming the file and the element.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/model/arm_model.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;

namespace {

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? text : text.replace(at, old.size(), by);
}

struct Bad {
  const char *in, *old, *by, *message;
};

class BadArm : public testing::TestWithParam<Bad> {};

TEST_P(BadArm, IsRefusedByName) {
  const Bad& bad = GetParam();
  test::ArmFiles files = test::foreign_arms()[1];
  std::string& text = std::string(bad.in) == "urdf" ? files.urdf : files.toml;
  text = replaced(text, bad.old, bad.by);
  const auto arm = model::ArmModel::parse(files.urdf, files.toml);
  ASSERT_FALSE(arm);
  EXPECT_NE(arm.error().message().find(bad.message), std::string::npos) << arm.error().message();
  EXPECT_NE(arm.error().message().find(std::string("arm.") + bad.in), std::string::npos)
      << arm.error().message();
}

INSTANTIATE_TEST_SUITE_P(
    Files, BadArm,
    testing::Values(
        Bad{"urdf", "<limit lower=\"-2.897300\" upper=\"2.897300\"",
            "<limit lower=\"2\" upper=\"-2\"", "joint1"},
        Bad{"urdf", "velocity=\"2.175000\"", "velocity=\"0\"", "velocity limit"},
        Bad{"urdf", "effort=\"80\"", "effort=\"0\"", "joint1"},
        Bad{"urdf", "type=\"revolute\"", "type=\"prismatic\"", "slides"},
        Bad{"urdf", "type=\"revolute\"", "type=\"continuous\"", "joint1"},
        Bad{"urdf", "<parent link=\"link2\"/>", "<parent link=\"link1\"/>", "branches off"},
        Bad{"urdf", "upper=\"2.897300\"", "upper=\"nan\"", "arm.urdf"},
        Bad{"urdf", "<limit lower=\"-2.897300\" upper=\"2.897300\"",
            "<limit lower=\"-20\" upper=\"20\"",
            "may turn by 40.0 rad; 26 are allowed, four turns"},
        Bad{"urdf", "<limit lower=\"-2.897300\"",
            "<mimic joint=\"joint2\"/><limit lower=\"-2.897300\"",
            "joint joint1: follows another joint"},
        Bad{"toml", "home = [0,", "home = [", "home"},
        Bad{"toml", "home = [0,", "home = [9,", "outside the limits of joint joint1"},
        Bad{"toml", "[end]", "[ned]", "unknown key"},
        Bad{"toml", "orientation = [1, 0, 0, 0]", "orientation = [0, 0, 0, 0]", "end"},
        Bad{"toml", "[end]", "redundant = \"elbow\"\n[end]", "redundant"},
        Bad{"toml", "[end]", "payload = -1\n[end]", "payload"},
        Bad{"toml", "[end]", "[collision]\nnot_checked = [[\"a\", \"b\"]]\n[end]", "names no link"},
        Bad{"toml", "[end]", "collision = 1\n[end]", "must be a table [collision]"},
        Bad{"toml", "[end]", "[collision]\nnot_checked = \"a\"\n[end]",
            "not_checked: needs pairs of links, as [[\"a\", \"b\"]]"},
        Bad{"toml", "[end]", "[collision]\nnot_checked = [[\"a\"]]\n[end]",
            "not_checked: needs pairs of links, as [[\"a\", \"b\"]]"},
        Bad{"toml", "[end]", "[limits]\nvelocity = [1, 1, 1, 1, 1, 1, -1]\n[end]", "velocity"},
        Bad{"toml", "[end]", "[limits]\nlower = [4, -1, -1, -3, -1, 0, -1]\n[end]",
            "lower must be less"},
        Bad{"toml", "name = \"seven_offset\"", "name = ", "line 1"}));

TEST(ArmFile, FiveAndEightJointsAreNoArm) {
  test::ArmFiles files = test::foreign_arms()[0];
  const std::string fixed = replaced(files.urdf, "type=\"revolute\"", "type=\"fixed\"");
  const auto five = model::ArmModel::parse(fixed, files.toml);
  ASSERT_FALSE(five);
  EXPECT_NE(five.error().message().find("has 5 joints that move; an arm has 6 or 7"),
            std::string::npos)
      << five.error().message();
}

// `arm add -o mine` made a folder that `arm solve mine` did not find, as it has no slash.
TEST(ArmFile, AFolderThatLiesHereNeedsNoSlash) {
  const auto before = std::filesystem::current_path();
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("arms" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "mine");
  std::filesystem::create_directories(folder / "puma560");
  for (const char* name : {"mine", "puma560"}) std::ofstream(folder / name / "arm.toml") << "";
  std::filesystem::current_path(folder);
  EXPECT_EQ(model::arm_directory("mine"), "mine");
  EXPECT_NE(model::arm_directory("puma560"), "puma560") << "a name comes first";
  EXPECT_NE(model::arm_directory("nobody"), "nobody");
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
}

TEST(ArmFile, LimitsOfTheTomlHold) {
  test::ArmFiles files = test::foreign_arms()[0];
  files.toml += "[limits]\nacceleration = [1, 2, 3, 4, 5, 6]\n";
  const auto arm = model::ArmModel::parse(files.urdf, files.toml);
  ASSERT_TRUE(arm) << arm.error().message();
  EXPECT_EQ(arm->joints[5].acceleration, 6);
  EXPECT_EQ(arm->redundant, -1);
  EXPECT_EQ(test::arm("seven_offset").redundant, 2);
}

}  // namespace
