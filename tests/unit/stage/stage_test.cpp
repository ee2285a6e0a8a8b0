// A stage ends what is awaited: when it is there, when it is late, and when a process dies.
#include "common/stage/stage.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "common/base/file_text.hpp"
#include "common/stage/first_training.hpp"

namespace prehend::stage {
namespace {

Error late() {
  return {"never came", "test", ""};
}

Expected<Stage> stage(double timeout = 60) {
  return Stage::create({.lab = {}, .timeout = timeout});
}

/// A program of the system that is given a lab, of which it knows nothing.
Expected<void> start(Stage& stage, const std::string& script) {
  return stage.start("child", "/bin/sh", {"-c", script, "child"});
}

TEST(Stage, TellsEachProcessOfItsRigAndSettings) {
  auto made = stage();
  ASSERT_TRUE(made);
  made->set("lab.domain=17");
  const auto file = made->folder() / "told";
  ASSERT_TRUE(start(*made, "echo \"$@\" > " + file.string() + ".part; mv " + file.string() +
                               ".part " + file.string() + "; exec sleep 60"));
  ASSERT_TRUE(made->until_there("waiting", file, late));
  const std::string told = *read_file(file);
  EXPECT_NE(told.find("--set lab.rig=demo-"), std::string::npos) << told;
  EXPECT_NE(told.find("--set lab.domain=17"), std::string::npos) << told;
  EXPECT_NE(told.find("--config "), std::string::npos) << told;
}

TEST(Stage, TwoAreNotInOneRig) {
  const auto a = stage(), b = stage();
  ASSERT_TRUE(a && b);
  EXPECT_NE(a->sets(), b->sets());
}

TEST(Stage, WhatNeverComesIsLate) {
  auto made = stage(0.05);
  ASSERT_TRUE(made);
  const auto ended = made->until(
      "waiting", [] { return false; }, late);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().what, "never came");
}

TEST(Stage, AProcessThatDiedIsNamedWithItsLastWords) {
  auto made = stage();
  ASSERT_TRUE(made);
  ASSERT_TRUE(start(*made, "echo no camera; exit 3"));
  const auto ended = made->until(
      "waiting", [] { return false; }, late);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().where, "child");
  EXPECT_NE(ended.error().what.find("exit code 3"), std::string::npos) << ended.error().what;
  EXPECT_NE(ended.error().what.find("no camera"), std::string::npos) << ended.error().what;
}

TEST(Stage, WhoMayEndMayDoSoWithSuccess) {
  auto made = stage();
  ASSERT_TRUE(made);
  made->may_end("child");
  ASSERT_TRUE(start(*made, "exit 0"));
  EXPECT_TRUE(made->until(
      "waiting", [&] { return made->has_ended("child"); }, late));
  EXPECT_TRUE(made->look("after it"));
}

TEST(Stage, AProgramIsRunToItsEnd) {
  auto made = stage();
  ASSERT_TRUE(made);
  int looks = 0;
  made->on_look([&] { return std::to_string(++looks); });
  const auto exit =
      made->run("running", "/bin/sh", {"-c", "echo out; echo err >&2; sleep 0.1; exit 7"}, {},
                made->folder() / "output");
  ASSERT_TRUE(exit) << exit.error().message();
  EXPECT_EQ(exit->code, 7);
  EXPECT_EQ(*read_file(made->folder() / "output"), "out\n");
  EXPECT_GT(looks, 0);
}

TEST(FirstTraining, OfAHandThatIsNoneFails) {
  const auto trained = train_if_needed("no_such_hand", [] { return false; });
  ASSERT_FALSE(trained);
  EXPECT_EQ(trained.error().message(),
            "no_such_hand: could not be trained (prehend train --hand no_such_hand)");
}

TEST(StageDeathTest, CtrlCEndsIt) {
  const auto interrupt = [] {
    auto made = stage();
    std::raise(SIGINT);
    const auto ended = made->until(
        "waiting", [] { return false; }, late);
    std::exit(ended ? exit_done : ended.error().exit);
  };
  EXPECT_EXIT(interrupt(), testing::ExitedWithCode(exit_no), "");
}

}  // namespace
}  // namespace prehend::stage
