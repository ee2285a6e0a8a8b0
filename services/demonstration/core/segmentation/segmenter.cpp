#include "services/demonstration/core/segmentation/segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "services/demonstration/core/segmentation/semi_markov.hpp"

namespace prehend::demonstration {

namespace {

constexpr double never = -std::numeric_limits<double>::infinity();
constexpr double floor_log = -12;  // of a signal: one outlier does not forbid a phase

/// What tells phases apart, at each sample.
struct Signals {
  Eigen::VectorXd speed;     // of the hand, m/s
  Eigen::VectorXd rate;      // of the aperture, m/s
  Eigen::VectorXd distance;  // to the nearest object, m; NaN: none is seen
};

/// Slope of a straight line through what lies within half a window around a sample.
template <class Value>
Value slope(const std::vector<double>& t, const std::vector<Value>& x, std::size_t at,
            double window) {
  std::size_t begin = at, end = at + 1;
  while (begin > 0 && t[at] - t[begin - 1] <= window / 2) --begin;
  while (end < t.size() && t[end] - t[at] <= window / 2) ++end;
  if (begin == at && at > 0) --begin;
  if (end == at + 1 && end < t.size()) ++end;
  double mean = 0, square = 0;
  Value sum = x[at] * 0.0, product = x[at] * 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    mean += t[i];
    sum += x[i];
  }
  mean /= static_cast<double>(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    square += (t[i] - mean) * (t[i] - mean);
    product += (t[i] - mean) * x[i];
  }
  return product / square;
}

/// Nearest object and its distance.
std::pair<std::optional<std::size_t>, double> nearest(const SceneSample& sample) {
  std::pair<std::optional<std::size_t>, double> best{std::nullopt, std::nan("")};
  for (std::size_t i = 0; i < sample.p_WO.size(); ++i) {
    if (!sample.p_WO[i]) continue;
    const double distance = (*sample.p_WO[i] - sample.p_WG).norm();
    if (!best.first || distance < best.second) best = {i, distance};
  }
  return best;
}

Signals signals_of(const std::vector<SceneSample>& samples, double window) {
  std::vector<double> t, aperture;
  std::vector<Eigen::Vector3d> places;
  for (const SceneSample& sample : samples) {
    t.push_back(sample.t);
    aperture.push_back(sample.aperture);
    places.push_back(sample.p_WG);
  }
  const auto count = static_cast<Eigen::Index>(samples.size());
  Signals made{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    made.speed[at] = slope(t, places, i, window).norm();
    made.rate[at] = slope(t, aperture, i, window);
    made.distance[at] = nearest(samples[i]).second;
  }
  return made;
}

double log_normal(double x, double sigma) {
  return -0.5 * x * x / (sigma * sigma) - std::log(sigma * std::sqrt(2 * std::numbers::pi));
}

/// Of a number that has one sign: half a normal curve, softened by the noise.
double log_one_way(double x, double scale, double noise) {
  return x >= 0 ? log_normal(x, scale) + std::numbers::ln2
                : log_normal(0, scale) + std::numbers::ln2 - 0.5 * x * x / (noise * noise);
}

/// log p of what a phase shows, by what is known of hands.
class Scores {
 public:
  explicit Scores(const SegmenterOptions& options) : options_(options) {}

  Eigen::MatrixXd of(const Signals& signals) const {
    Eigen::MatrixXd made(static_cast<Eigen::Index>(phase_count), signals.speed.size());
    for (Eigen::Index t = 0; t < made.cols(); ++t)
      for (std::size_t p = 0; p < phase_count; ++p)
        made(static_cast<Eigen::Index>(p), t) =
            log(phases[p], signals.speed[t], signals.rate[t], signals.distance[t]);
    return made;
  }

 private:
  double still(double speed) const { return log_one_way(speed, options_.still_speed, 1e-3); }
  double moving(double speed) const { return log_one_way(speed, options_.moving_speed, 1e-3); }
  double stays(double rate) const { return log_normal(rate, options_.still_rate); }
  double any(double rate) const { return log_normal(rate, options_.closing_rate); }
  double closes(double rate) const {
    return log_one_way(-rate, options_.closing_rate, options_.still_rate);
  }
  double near(double distance) const {
    return std::isnan(distance) ? 0 : log_one_way(distance, options_.near, 1e-3);
  }
  double far(double distance) const {
    return std::isnan(distance) ? 0 : log_one_way(distance, options_.far, 1e-3);
  }

  double log(Phase phase, double speed, double rate, double distance) const {
    const auto sum = [](double a, double b, double c) {
      return std::max(a, floor_log) + std::max(b, floor_log) + std::max(c, floor_log);
    };
    switch (phase) {
      case Phase::rest:
        return sum(still(speed), stays(rate), far(distance));
      case Phase::approach:
        // Fingers open on the way or stay: closing is the next phase.
        return sum(moving(speed), std::max(stays(rate), closes(-rate)) - std::numbers::ln2,
                   far(distance));
      case Phase::close:
        return sum(std::max(moving(speed), still(speed)) - std::numbers::ln2, closes(rate),
                   near(distance));
      case Phase::hold:
        return sum(std::max(moving(speed), still(speed)) - std::numbers::ln2, stays(rate),
                   near(distance));
      case Phase::release:
        return sum(still(speed), closes(-rate), near(distance));
      case Phase::retract:
        return sum(moving(speed), any(rate), far(distance));
    }
    return never;
  }

  const SegmenterOptions& options_;
};

SemiMarkovOptions model_of(const SegmenterOptions& options, double period) {
  constexpr auto n = static_cast<Eigen::Index>(phase_count);
  SemiMarkovOptions made{Eigen::MatrixXd::Constant(n, n, never),
                         Eigen::VectorXd::Constant(n, never), Eigen::VectorXi(n),
                         Eigen::VectorXi(n)};
  const auto follows = [&](Phase from, Phase to, double p) {
    made.log_transition(static_cast<Eigen::Index>(from), static_cast<Eigen::Index>(to)) =
        std::log(p);
  };
  follows(Phase::rest, Phase::approach, 1);
  follows(Phase::approach, Phase::close, 0.95);
  follows(Phase::approach, Phase::rest, 0.05);  // it has thought better of it
  follows(Phase::close, Phase::hold, 1);
  follows(Phase::hold, Phase::release, 1);
  follows(Phase::release, Phase::retract, 1);
  follows(Phase::retract, Phase::rest, 0.7);
  follows(Phase::retract, Phase::approach, 0.3);
  made.log_initial[static_cast<Eigen::Index>(Phase::rest)] = std::log(0.8);
  made.log_initial[static_cast<Eigen::Index>(Phase::approach)] = std::log(0.2);
  for (std::size_t p = 0; p < phase_count; ++p) {
    const auto at = static_cast<Eigen::Index>(p);
    made.min_length[at] =
        std::max(1, static_cast<int>(std::lround(options.min_duration[p] / period)));
    made.max_length[at] = std::max(made.min_length[at],
                                   static_cast<int>(std::lround(options.max_duration[p] / period)));
  }
  return made;
}

Expected<void> check(const std::vector<SceneSample>& samples) {
  if (samples.size() < 3) return fail("a demonstration has fewer than three samples");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SceneSample& sample = samples[i];
    bool sound =
        std::isfinite(sample.t) && sample.p_WG.allFinite() && std::isfinite(sample.aperture);
    for (const auto& p_WO : sample.p_WO) sound &= !p_WO || p_WO->allFinite();
    if (!sound) return fail("a number is not finite", "sample " + std::to_string(i));
    if (i > 0 && !(sample.t > samples[i - 1].t))
      return fail("time does not rise", "sample " + std::to_string(i));
  }
  return {};
}

/// The object that was nearest most of the time.
std::optional<std::size_t> object_of(const std::vector<SceneSample>& samples,
                                     const Stretch& stretch) {
  std::vector<int> counts;
  for (Eigen::Index t = stretch.begin; t < stretch.end; ++t) {
    const auto object = nearest(samples[static_cast<std::size_t>(t)]).first;
    if (!object) continue;
    counts.resize(std::max(counts.size(), *object + 1), 0);
    ++counts[*object];
  }
  if (counts.empty()) return std::nullopt;
  return static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

}  // namespace

Expected<std::vector<Segment>> segment(const std::vector<SceneSample>& samples,
                                       const SegmenterOptions& options) {
  if (auto ok = check(samples); !ok) return tl::unexpected(ok.error());
  const double period =
      (samples.back().t - samples.front().t) / static_cast<double>(samples.size() - 1);
  const auto path =
      decode(Scores(options).of(signals_of(samples, options.window)), model_of(options, period));
  if (!path) return tl::unexpected(path.error());
  std::vector<Segment> made;
  for (const Stretch& stretch : path->stretches) {
    const Phase phase = phases[static_cast<std::size_t>(stretch.state)];
    const bool has_object =
        phase == Phase::close || phase == Phase::hold || phase == Phase::release;
    const double begin = samples[static_cast<std::size_t>(stretch.begin)].t;
    if (!made.empty()) made.back().end = begin;
    made.push_back(
        {phase, begin, samples.back().t, has_object ? object_of(samples, stretch) : std::nullopt});
  }
  return made;
}

}  // namespace prehend::demonstration
