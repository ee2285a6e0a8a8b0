#include "services/glove/core/filter_report.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/random.hpp"
#include "services/glove/core/features.hpp"
#include "services/glove/core/processor.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

constexpr double begin = 0.3;            // s, until then filters settle and nothing is counted
constexpr double half_span = 1. / 30;    // s, to both sides, over which a speed is measured
constexpr double delay_step = 0.1 / 80;  // s

/// The fingertips of all frames, in H.
using Tips = std::vector<std::array<Fingertip, model::finger_count>>;

Tips tips_of(const std::vector<Frame>& frames) {
  Tips tips;
  for (const Frame& frame : frames) {
    auto& now = tips.emplace_back();
    const Reading& back = frame.readings.front();
    for (const Reading& reading : frame.readings)
      if (const auto finger = finger_of(reading.site))
        now[static_cast<std::size_t>(*finger)] = {
            true, invariant_feature(make_pose(back.p_TS, back.q_TS), reading.p_TS)};
  }
  return tips;
}

Tips published(const std::vector<Frame>& frames) {
  Processor processor({});
  Tips tips;
  for (const Frame& frame : frames) {
    const Processed processed = processor.process(frame, frame.stamp);
    auto& now = tips.emplace_back();
    if (processed.posture) now = processed.posture->fingertips;
  }
  return tips;
}

/// Where a fingertip truly was at a time, between frames on a straight line; from frame k back.
Vector3d at(const std::vector<double>& times, const Tips& truth, std::size_t f, std::size_t k,
            double time) {
  while (k > 0 && times[k] > time) --k;
  if (k + 1 == times.size() || times[k] > time) return truth[k][f].p_HF;
  const double share = (time - times[k]) / (times[k + 1] - times[k]);
  return (1 - share) * truth[k][f].p_HF + share * truth[k + 1][f].p_HF;
}

}  // namespace

void FilterMeasurement::add(const std::vector<Frame>& truth) {
  std::vector<Frame> noisy = truth;
  Random random(noise_.seed + 7919 * frames_);
  for (Frame& frame : noisy)
    for (Reading& reading : frame.readings) reading.p_TS += random.normal3(noise_.sigma);
  std::vector<Frame> extreme = noisy;
  for (Frame& frame : extreme)
    for (Reading& reading : frame.readings)
      if (random.uniform() < noise_.extreme_rate) {
        ++extremes_;
        reading.p_TS += random.normal3(1).normalized() *
                        random.uniform(noise_.extreme_least, noise_.extreme_most);
      }

  const Tips truly = tips_of(truth), raw = tips_of(noisy), out = published(noisy),
             disturbed = published(extreme);
  std::vector<double> times;
  for (const Frame& frame : truth) times.push_back(to_seconds(frame.stamp - truth.front().stamp));
  frames_ += truth.size();
  for (std::size_t k = 0; k < truth.size(); ++k)
    for (std::size_t f = 0; f < model::finger_count; ++f) {
      if (times[k] < begin || !out[k][f].valid) continue;
      const Vector3d &p = out[k][f].p_HF, &x = truly[k][f].p_HF;
      ++published_;
      if (disturbed[k][f].valid) {
        const double moved = (disturbed[k][f].p_HF - p).norm();
        moved_ = std::max(moved_, moved);
        far_ += moved > moved_aim;
      } else {
        ++withheld_;
      }
      if (times[k] + half_span > times.back()) continue;
      const auto ahead = static_cast<std::size_t>(
          std::lower_bound(times.begin(), times.end(), times[k] + half_span) - times.begin());
      const double speed = (at(times, truly, f, ahead, times[k] + half_span) -
                            at(times, truly, f, k, times[k] - half_span))
                               .norm() /
                           (2 * half_span);
      if (speed < slow_speed) {
        ++slow_;
        in_ += (raw[k][f].p_HF - x).squaredNorm();
        out_ += (p - x).squaredNorm();
      } else if (speed > fast_speed) {
        ++fast_;
        for (int d = 0; d < delays; ++d)
          delayed_[static_cast<std::size_t>(d)] +=
              (p - at(times, truly, f, k, times[k] - d * delay_step)).squaredNorm();
      }
    }
}

void FilterMeasurement::add(const FilterMeasurement& other) {
  frames_ += other.frames_, slow_ += other.slow_, fast_ += other.fast_;
  extremes_ += other.extremes_, published_ += other.published_, withheld_ += other.withheld_;
  far_ += other.far_;
  in_ += other.in_, out_ += other.out_;
  moved_ = std::max(moved_, other.moved_);
  for (std::size_t d = 0; d < delayed_.size(); ++d) delayed_[d] += other.delayed_[d];
}

FilterStats FilterMeasurement::stats() const {
  FilterStats stats{.frames = frames_, .slow = slow_, .fast = fast_, .extremes = extremes_};
  const double slow = 3 * std::max<double>(1, static_cast<double>(slow_));
  stats.noise_in = std::sqrt(in_ / slow);
  stats.noise_out = std::sqrt(out_ / slow);
  stats.lag = delay_step * static_cast<double>(std::min_element(delayed_.begin(), delayed_.end()) -
                                               delayed_.begin());
  stats.moved = moved_;
  stats.far = far_;
  stats.withheld =
      static_cast<double>(withheld_) / std::max<double>(1, static_cast<double>(published_));
  return stats;
}

std::vector<Frame> frames_of(const FrameSource& source, double rate) {
  std::vector<Frame> all;
  for (std::uint64_t n = 0; auto frame = source.frame(n); ++n) all.push_back(std::move(*frame));
  if (rate <= 0 || all.empty()) return all;
  std::vector<Frame> thinned;
  std::size_t next = 1;
  for (Time stamp = all.front().stamp; stamp <= all.back().stamp; stamp += seconds(1 / rate)) {
    while (next + 1 < all.size() && all[next].stamp < stamp) ++next;
    const Frame &a = all[next - 1], &b = all[next];
    const double share = to_seconds(stamp - a.stamp) / to_seconds(b.stamp - a.stamp);
    Frame frame = a;
    frame.sequence = thinned.size();
    frame.stamp = stamp;
    for (std::size_t s = 0; s < frame.readings.size(); ++s)
      frame.readings[s].p_TS += share * (b.readings[s].p_TS - a.readings[s].p_TS);
    thinned.push_back(std::move(frame));
  }
  return thinned;
}

}  // namespace prehend::glove
