// The aims of the filter, on every real recording of a bare hand at its own rate (about 110 Hz),
// with a magnetic tracker's noise added to every sensor, the back of the hand's too: sigma 1.5 mm a
// coordinate, 1 % extreme points of 5 to 50 cm. Below 5 cm/s the error of a published fingertip is
// at most half of what the noise gives an unfiltered one; above 20 cm/s it lags at most a frame at
// 30 Hz; no extreme point moves it by more than 5 mm against the same noise without extreme points.
//
// At 30 Hz the first aim cannot be met: half of the noise takes three frames to average, in which a
// finger at 2.5 cm/s goes 2 mm. What is reached there is printed, and held against getting worse.
#include "services/glove/core/filter_report.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "services/glove/files/hand_recording.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::glove {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  return shared_data() / "leap_hand_recordings";
}

constexpr std::array names{"HandSplay-110fps",
                           "Waiting-110fps",
                           "brian",
                           "confidence-demo",
                           "flapping",
                           "grab",
                           "gun",
                           "pinch",
                           "rollAndPitchWithEntry",
                           "three-claps",
                           "wave"};

void print(const char* name, const FilterStats& f) {
  std::printf(
      "%-22s %6zu frames: noise %.2f mm in, %.2f mm out (%.2f), lag %4.1f ms, "
      "%4zu extreme points moved at most %.1f mm, %.2f %% withheld\n",
      name, f.frames, 1000 * f.noise_in, 1000 * f.noise_out, f.noise_out / f.noise_in,
      f.fast > 0 ? 1000 * f.lag : 0.0, f.extremes, 1000 * f.moved, 100 * f.withheld);
}

/// All recordings, each `rounds` times with other noise; checks each by itself.
template <class Check>
FilterStats measure(double rate, int rounds, const Check& check) {
  FilterMeasurement all(TrackerNoise{});
  for (const char* name : names) {
    const auto recording = Recording::load(folder() / (std::string(name) + ".csv"), {});
    if (!recording) {
      ADD_FAILURE() << recording.error().message();
      continue;
    }
    FilterMeasurement one(TrackerNoise{});
    const auto frames = frames_of(*recording, rate);
    for (int round = 0; round < rounds; ++round) one.add(frames);
    print(name, one.stats());
    check(name, one.stats());
    all.add(one);
  }
  print("all", all.stats());
  return all.stats();
}

TEST(FilterReport, MeetsTheAimsOnEveryRecording) {
  if (!fs::exists(folder())) GTEST_SKIP() << "no " << folder();
  const auto all = measure(0, 10, [](const char* name, const FilterStats& f) {
    EXPECT_GT(f.slow, 100u) << name;
    EXPECT_LE(f.noise_out, f.noise_in / 2) << name;
    if (f.fast > 0) {
      EXPECT_LE(f.lag, 1. / 30) << name;
    }
    EXPECT_LE(f.moved, 0.005) << name;
    // The back of the hand's extreme points, 1 %, take the whole frame; 1 % of each finger's are
    // carried over where the finger is slow.
    EXPECT_LE(f.withheld, 0.025) << name;
  });
  EXPECT_GT(all.extremes, 2000u);
  EXPECT_NEAR(all.noise_in, 0.0015 * std::sqrt(2), 0.0001) << "two sensors' noise, as injected";
}

TEST(FilterReport, SaysWhatThirtyHertzAllow) {
  if (!fs::exists(folder())) GTEST_SKIP() << "no " << folder();
  const auto all = measure(30, 10, [](const char* name, const FilterStats& f) {
    if (f.fast > 0) {
      EXPECT_LE(f.lag, 1. / 30) << name;
    }
  });
  EXPECT_LE(all.noise_out, 0.65 * all.noise_in);
}

// The measure itself: without noise there is none, and what is delayed is found so.
TEST(FilterReport, MeasuresNothingWhereNothingIsAdded) {
  std::vector<Frame> frames;
  for (int n = 0; n < 300; ++n) {
    Frame frame;
    frame.stamp = Time(seconds(n / 100.));
    frame.readings.push_back({Site::back_of_hand, true, {0.1, 0, 0.2}});
    frame.readings.push_back({Site::index, true, {0.24, 0.03 + 0.03 * std::sin(n / 100.), 0.15}});
    frames.push_back(frame);
  }
  FilterMeasurement clean(TrackerNoise{.sigma = 0, .extreme_rate = 0});
  clean.add(frames);
  EXPECT_EQ(clean.stats().noise_in, 0);
  EXPECT_LT(clean.stats().noise_out, 0.0015) << "lag alone";
  EXPECT_EQ(clean.stats().moved, 0);
  EXPECT_EQ(clean.stats().withheld, 0);
  EXPECT_GT(clean.stats().slow, 200u);
}

}  // namespace
}  // namespace prehend::glove
