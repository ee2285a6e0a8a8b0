// How late the default filter is, on real hands. The lag of a filter y of a motion x is the delay τ
// that explains it best: min over τ of Σ |y(t) − x(t − τ)|², x between frames taken as straight,
// over all fingertips in H and all frames; in frames of 33 ms, the tracker's, for which recordings
// are thinned out. An exponential filter y += α (x − y) lags a ramp by (1 − α)/α frames: four for
// α = 0.2, the default of dex-retargeting; it is measured beside, and so is the measure.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "services/glove/core/features.hpp"
#include "services/glove/core/one_euro.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

constexpr double frame_time = 1 / 30.;  // s

/// Positions of one fingertip at equal times, raw and filtered.
struct Path {
  std::vector<Vector3d> raw, euro, exponential;
};

void filter(Path& path) {
  PointFilter euro{OneEuroOptions{}};
  Vector3d low = path.raw.front();
  for (std::size_t k = 0; k < path.raw.size(); ++k) {
    path.euro.push_back(euro(Time(seconds(1 + frame_time * static_cast<double>(k))), path.raw[k]));
    path.exponential.push_back(low += 0.2 * (path.raw[k] - low));
  }
}

/// In frames.
double lag(const std::vector<Path>& paths, std::vector<Vector3d> Path::*filtered) {
  constexpr int most = 8;
  double best = 0, least = INFINITY;
  for (double tau = 0; tau <= most; tau += 0.01) {
    double sum = 0;
    for (const Path& path : paths)
      for (std::size_t k = most + 1; k < path.raw.size(); ++k) {
        const auto whole = static_cast<std::size_t>(tau);
        const double part = tau - static_cast<double>(whole);
        const Vector3d x = (1 - part) * path.raw[k - whole] + part * path.raw[k - whole - 1];
        sum += ((path.*filtered)[k] - x).squaredNorm();
      }
    if (sum < least) least = sum, best = tau;
  }
  return best;
}

/// All fingertips of a recording, 30 times a second.
std::vector<Path> fingertips(const Recording& recording) {
  std::vector<Path> paths(model::finger_count);
  const auto at = [&](std::uint64_t n) { return to_seconds(recording.frame(n)->stamp - Time{}); };
  std::uint64_t n = 1;
  for (double t = 0; n < recording.size(); t += frame_time) {
    while (n < recording.size() && at(n) < t) ++n;
    if (n == recording.size()) break;
    const double share = (t - at(n - 1)) / (at(n) - at(n - 1));
    const auto tip = [&](std::uint64_t frame, std::size_t f) {
      const auto readings = recording.frame(frame)->readings;
      return invariant_feature(make_pose(readings[0].p_TS, readings[0].q_TS), readings[f + 1].p_TS);
    };
    for (std::size_t f = 0; f < paths.size(); ++f)
      paths[f].raw.push_back((1 - share) * tip(n - 1, f) + share * tip(n, f));
  }
  for (Path& path : paths) filter(path);
  return paths;
}

TEST(FilterLag, OfAnExponentialFilterOnARampIsFourFrames) {
  Path ramp;
  for (int k = 0; k < 100; ++k) ramp.raw.push_back({0.01 * k, 0, 0});
  filter(ramp);
  ramp.raw.erase(ramp.raw.begin(), ramp.raw.begin() + 50);  // it takes some time to settle
  ramp.exponential.erase(ramp.exponential.begin(), ramp.exponential.begin() + 50);
  EXPECT_NEAR(lag({ramp}, &Path::exponential), 4, 0.02);
}

TEST(FilterLag, IsAtMostOneFrameOnRealHands) {
  const fs::path folder = shared_data() / "leap_hand_recordings";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::vector<Path> all;
  for (const char* name : {"grab", "pinch", "HandSplay-110fps"}) {
    const auto recording = Recording::load(folder / (std::string(name) + ".csv"), {});
    ASSERT_TRUE(recording) << recording.error().message();
    const auto paths = fingertips(*recording);
    RecordProperty(std::string(name) + "_frames", std::to_string(lag(paths, &Path::euro)));
    all.insert(all.end(), paths.begin(), paths.end());
  }
  const double ours = lag(all, &Path::euro), theirs = lag(all, &Path::exponential);
  RecordProperty("frames", std::to_string(ours));
  RecordProperty("exponential_frames", std::to_string(theirs));
  std::printf("lag: One Euro %.2f frames, exponential (0.2) %.2f frames\n", ours, theirs);
  EXPECT_LE(ours, 1);
  EXPECT_GT(theirs, ours);
}

}  // namespace
}  // namespace prehend::glove
