// Which label of a recorded session cannot be used, and why.
#include "services/mapping/tools/teach/teach_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"
#include "tests/unit/recorder_dataset_files/written_recording.hpp"

namespace prehend::mapping {
namespace {

v1::HandPosture recorded_hand(int ms, double closure) {
  v1::HandPosture message;
  message.stamp_ns(to_ns(recorder::dataset::ms(ms)));
  message.hand_scale(1);
  message.X_WH(convert::to_message(make_pose({0, 0, 0.2})));
  const Fingertips seen = tips({closure, closure, closure, closure, closure});
  for (std::size_t f = 0; f < seen.size(); ++f) {
    message.fingertips()[f].valid(true);
    message.fingertips()[f].p_HF(convert::to_message(seen[f].p_HF));
  }
  return message;
}

TEST(TeachRecording, SaysWhichLabelCannotBeUsed) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("session" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  {
    recorder::dataset::WrittenRecording empty(folder / "empty.mcap"), good(folder / "good.mcap");
    // Still for 1.5 s, and then it closes.
    for (int t = 0; t <= 3000; t += 20)
      good.write(dds::hand_posture, t, recorded_hand(t, std::max(0.0, (t - 1500) / 1500.0)));
    empty.close();
    good.close();
  }
  const auto scheme =
      Scheme::load(test::in_sources("services/mapping/schemes/barrett.toml"), barrett()).value();
  const auto said = [&](const char* file, const std::multimap<std::string, double>& labels) {
    const auto made = shown_in(folder / file, labels,
                               curriculum(barrett(), scheme, "pupil", 1, 7, {}), TeachOptions{});
    return made ? std::to_string(made->size()) : made.error().message();
  };
  using ::testing::HasSubstr;
  EXPECT_EQ(said("good.mcap", {{"open", 1.4}}), "1");
  EXPECT_THAT(said("empty.mcap", {{"open", 1.4}}), HasSubstr("holds no usable hand/posture"));
  EXPECT_THAT(said("good.mcap", {}),
              HasSubstr("nobody said what was shown (give --label POSTURE@SECONDS)"));
  EXPECT_THAT(said("good.mcap", {{"fist", 1.4}}), HasSubstr("the scheme knows no «fist»"));
  EXPECT_THAT(said("good.mcap", {{"open", 0}}), HasSubstr("too few postures before «open»"));
  EXPECT_THAT(
      said("good.mcap", {{"open", 2.5}}),
      ::testing::ContainsRegex("the hand moved [0-9]+ mm before «open» .label where it is"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::mapping
