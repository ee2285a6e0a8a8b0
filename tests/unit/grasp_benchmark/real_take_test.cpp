// Recordings of real hands. The reader is held against the glove service's own, which was written
// for another purpose: the same fingertips in H to 1e-6 m, what rounding of angles leaves. Bad
// files are refused by name.
#include "services/mapping/tools/judging/real_take.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "services/glove/core/features.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::mapping {
namespace {

const std::filesystem::path folder = shared_data() / "leap_hand_recordings";

class RealTakes : public testing::TestWithParam<std::string> {};

TEST_P(RealTakes, AreTheFingertipsThatTheGloveSees) {
  const auto file = folder / (GetParam() + ".csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const auto take = load_real_take(file);
  ASSERT_TRUE(take) << take.error().message();
  EXPECT_GT(take->hand_scale, 0.8);
  EXPECT_LT(take->hand_scale, 1.25);
  const auto recording = glove::Recording::load(file, {.hand_scale = take->hand_scale});
  ASSERT_TRUE(recording) << recording.error().message();
  std::uint64_t n = 0;
  double before = -1;
  for (const RealTake::Frame& frame : take->frames) {
    EXPECT_GE(frame.time, before + 1 / 30. - 1e-5);
    before = frame.time;
    const auto time = [&](std::uint64_t k) {
      return to_seconds(recording->frame(k)->stamp - Time{});
    };
    while (n < recording->size() && time(n) < frame.time - 1e-5) ++n;
    ASSERT_LT(n, recording->size());
    const auto readings = recording->frame(n)->readings;
    const Pose X_TH = make_pose(readings[0].p_TS, readings[0].q_TS);
    for (std::size_t f = 0; f < frame.fingertips.size(); ++f)
      EXPECT_LT(
          (glove::invariant_feature(X_TH, readings[f + 1].p_TS) - frame.fingertips[f].p_HF).norm(),
          1e-6);
  }
  const auto grab = [](const auto& a, const auto& b) { return a.grab < b.grab; };
  const auto most = std::max_element(take->frames.begin(), take->frames.end(), grab);
  if (GetParam() == "grab") {
    EXPECT_EQ(most->grab, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Leap, RealTakes, testing::Values("grab", "pinch", "HandSplay-110fps"),
                         [](const auto& given) { return given.param.substr(0, 4); });

TEST(RealTake, RefusesWhatIsNoRecording) {
  using testing::HasSubstr;
  const auto file = std::filesystem::path(testing::TempDir()) /
                    ("real-take-" + std::to_string(::getpid()) + ".csv");
  const auto refusal = [&](const std::string& text) {
    std::ofstream(file) << text;
    const auto take = load_real_take(file);
    return take ? "loaded" : take.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("cannot be read"));
  EXPECT_THAT(refusal("a,b,c\n1,2,3\n"), HasSubstr("has 0 good rows"));
  EXPECT_THAT(refusal("t_us,hand\nnan,right\n,,,\n"), HasSubstr(file.string()));
  std::filesystem::remove(file);
  EXPECT_FALSE(load_real_take(file));
  EXPECT_FALSE(load_real_take(testing::TempDir()));
}

}  // namespace
}  // namespace prehend::mapping
