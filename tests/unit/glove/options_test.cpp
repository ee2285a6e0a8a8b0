// What the configuration may not say of a glove is refused by the name of its key.
#include "services/glove/service/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "common/base/file_text.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "services/glove/service/messages.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::glove {
namespace {

std::string options_said(const std::string& setting) {
  const auto options =
      service::Config::load(test::in_sources("deploy/lab.toml"), {setting})
          .and_then([](const service::Config& config) { return device_options(config); });
  return options ? "taken" : options.error().message();
}

TEST(GloveOptions, AreRefusedByTheirKeys) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("token" + std::to_string(getpid()));
  ASSERT_TRUE(write_file(file, "short\n"));
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>("glove.rate=100", "taken"),
        {"tracker.X_WT=[0, 0, 0]",
         "tracker.X_WT: needs seven numbers: x y z in m, then the quaternion w x y z (see"},
        {"glove.feedback_force=-1", "glove.feedback_force: is negative (N; 0: no finger is held"},
        {"glove.hand_scale=2", "glove.hand_scale: must lie in 0.7 to 1.4 (1 is an average adult)"},
        {"glove.token_file=/nowhere/token",
         "/nowhere/token: cannot be read (glove.token_file names it)"},
        {"glove.token_file=" + file.string(), "its first line is no token (16 letters"}})
    EXPECT_THAT(options_said(setting), ::testing::HasSubstr(words)) << setting;
  std::filesystem::remove(file);
}

TEST(GloveMessages, FeedbackThatIsNoForceIsRefused) {
  v1::GloveFeedback message;
  EXPECT_TRUE(from_message(message));
  for (const double force : {-1.0, HUGE_VAL, std::nan("")}) {
    message.fingers()[2].force(force);
    EXPECT_EQ(from_message(message).error().what, "feedback with a force below 0 or not finite")
        << force;
  }
}

TEST(RecordingOptions, NeedARate) {
  for (const double rate : {0.0, 1001.0, std::nan("")})
    EXPECT_EQ(
        Recording::parse("", "hand.csv", {.rate = rate}).error().message(),
        "hand.csv: the rate must be above 0 and at most 1000 Hz (set recording_rate of the scene)");
}

}  // namespace
}  // namespace prehend::glove
