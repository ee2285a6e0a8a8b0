// `prehend robot` says what is wrong before it joins a lab or opens a port.
#include "tests/support/command_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend {
namespace {

class RobotCommand : public test::CommandTest {
 protected:
  RobotCommand() : CommandTest(test::in_programs("prehend-robot-tool")) {}
};

TEST_F(RobotCommand, WhatCannotBeIsOneLine) {
  for (const auto& [arguments, words] :
       {std::pair("emulate --device toy", "--device: there is no emulator 'toy' (give barrett or "),
        {"emulate --stuck thumb", "--stuck: there is no joint 'thumb' (give one of spread, "},
        {"emulate --hand robonaut", "--hand robonaut: is not the hand of a barrett (give barrett)"},
        {"emulate --device dynamixel",
         "--hand: must be given: a dynamixel moves many hands (choose one of "},
        {"emulate --device ros2_control --hand barrett --link port",
         "--link: a ros2_control has no port (nodes of ROS 2 find it by its topics)"},
        {"emulate --twin hand", "--twin: the twin needs a name of its own (give twin)"},
        {"emulate --twin twin --set lab.keys=keys",
         "lab.keys: the twin of an emulated robot cannot join a lab with keys (emulate without "
         "--twin, or "},
        {"twin --twin hand", "--twin: the twin needs a name of its own (give twin)"},
        {"twin --set lab.keys=keys", "lab.keys: a twin is led in no lab with keys (leave "}}) {
    const auto answer = run(arguments + (" --config " + test::in_sources("deploy/lab.toml")));
    EXPECT_EQ(answer.code, exit_wrong_use) << arguments;
    EXPECT_THAT(answer.complaint, ::testing::HasSubstr(words)) << arguments;
  }
}

// A stop might be kept there.
TEST_F(RobotCommand, HomesNothingWhereAStopCannotBeLookedFor) {
  const auto state = in("lab.toml") + "/state";
  const auto answer = run("home --config " + file("lab.toml", "[robot]\nport = \"/dev/null\"\n") +
                          " --set safety.state=" + state);
  EXPECT_EQ(answer.code, exit_no);
  EXPECT_THAT(
      answer.complaint,
      ::testing::HasSubstr(state + ": Not a directory: whether the hand is stopped cannot be told "
                                   "(set safety.state to a folder)"));
}

}  // namespace
}  // namespace prehend
