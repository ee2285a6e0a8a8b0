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
  Eigen::VectorXd speed;                    // of the hand, m/s
  Eigen::VectorXd rate;                     // of the aperture, m/s
  Eigen::VectorXd distance;                 // to the nearest object, m; NaN: none is seen
  Eigen::VectorXd speed_noise, rate_noise;  // standard deviation of what noise adds, m/s
};

/// Standard deviation of a signal's noise: of its fourth differences, to which the smooth motion of
/// a hand adds next to nothing. The median does not mind some that do.
double noise_of(const std::vector<double>& x) {
  constexpr double of_fourth_differences = 8.366600265340756;  // √(1 + 16 + 36 + 16 + 1)
  constexpr double of_median = 0.6744897501960817;             // of |x|, x ~ N(0, 1)
  std::vector<double> differences;
  for (std::size_t i = 4; i < x.size(); ++i)
    differences.push_back(std::abs(x[i] - 4 * x[i - 1] + 6 * x[i - 2] - 4 * x[i - 3] + x[i - 4]));
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / (of_median * of_fourth_differences);
}

double noise_of(const std::vector<Eigen::Vector3d>& p) {
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> x;
    for (const Eigen::Vector3d& one : p) x.push_back(one[axis]);
    square += std::pow(noise_of(x), 2);
  }
  return std::sqrt(square);
}

/// Slope of a line, and by how much noise of standard deviation 1 moves it.
template <class Value>
struct Slope {
  Value value;
  double noise;
};

/// Slope of a straight line through what lies within half a window around a sample.
template <class Value>
Slope<Value> slope(const std::vector<double>& t, const std::vector<Value>& x, std::size_t at,
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
  return {product / square, 1 / std::sqrt(square)};
}

/// Nearest object of each sample, and its distance.
struct Nearest {
  std::optional<std::size_t> object;  // none: none has been seen yet
  double distance = std::nan("");
};

/// What is not seen keeps its distance from the hand: it is in it, or far from it all the same.
std::vector<Nearest> nearest_objects(const std::vector<SceneSample>& samples) {
  std::vector<Nearest> made;
  std::vector<std::optional<double>> distances;
  for (const SceneSample& sample : samples) {
    distances.resize(std::max(distances.size(), sample.p_WO.size()));
    Nearest best;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (i < sample.p_WO.size() && sample.p_WO[i])
        distances[i] = (*sample.p_WO[i] - sample.p_WG).norm();
      if (distances[i] && (!best.object || *distances[i] < best.distance))
        best = {i, *distances[i]};
    }
    made.push_back(best);
  }
  return made;
}

Signals signals_of(const std::vector<SceneSample>& samples, const std::vector<Nearest>& nearest,
                   double window) {
  std::vector<double> t, aperture;
  std::vector<Eigen::Vector3d> places;
  for (const SceneSample& sample : samples) {
    t.push_back(sample.t);
    aperture.push_back(sample.aperture);
    places.push_back(sample.p_WG);
  }
  const auto count = static_cast<Eigen::Index>(samples.size());
  Signals made{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count),
               Eigen::VectorXd(count), Eigen::VectorXd(count)};
  const double noise_of_place = noise_of(places), noise_of_aperture = noise_of(aperture);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const auto velocity = slope(t, places, i, window);
    const auto rate = slope(t, aperture, i, window);
    made.speed[at] = velocity.value.norm();
    made.speed_noise[at] = noise_of_place * velocity.noise;
    made.rate[at] = rate.value;
    made.rate_noise[at] = noise_of_aperture * rate.noise;
    made.distance[at] = nearest[i].distance;
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
            log(phases[p], signals.speed[t], signals.rate[t], signals.distance[t],
                std::hypot(options_.still_speed, signals.speed_noise[t]),
                std::hypot(options_.still_rate, signals.rate_noise[t]));
    return made;
  }

 private:
  // still_speed, still_rate: standard deviations of this sample, noise included.
  static double still(double speed, double still_speed) {
    return log_one_way(speed, still_speed, 1e-3);
  }
  double moving(double speed) const { return log_one_way(speed, options_.moving_speed, 1e-3); }
  static double stays(double rate, double still_rate) { return log_normal(rate, still_rate); }
  double any(double rate) const { return log_normal(rate, options_.closing_rate); }
  double closes(double rate, double still_rate) const {
    return log_one_way(-rate, options_.closing_rate, still_rate);
  }
  double near(double distance) const {
    return std::isnan(distance) ? 0 : log_one_way(distance, options_.near, 1e-3);
  }
  double far(double distance) const {
    return std::isnan(distance) ? 0 : log_one_way(distance, options_.far, 1e-3);
  }

  double log(Phase phase, double speed, double rate, double distance, double still_speed,
             double still_rate) const {
    const auto sum = [](double a, double b, double c) {
      return std::max(a, floor_log) + std::max(b, floor_log) + std::max(c, floor_log);
    };
    switch (phase) {
      case Phase::rest:
        return sum(still(speed, still_speed), stays(rate, still_rate), far(distance));
      case Phase::approach:
        // Fingers open on the way or stay: closing is the next phase.
        return sum(moving(speed),
                   std::max(stays(rate, still_rate), closes(-rate, still_rate)) - std::numbers::ln2,
                   far(distance));
      case Phase::close:
        return sum(std::max(moving(speed), still(speed, still_speed)) - std::numbers::ln2,
                   closes(rate, still_rate), near(distance));
      case Phase::hold:
        return sum(std::max(moving(speed), still(speed, still_speed)) - std::numbers::ln2,
                   stays(rate, still_rate), near(distance));
      case Phase::release:
        return sum(still(speed, still_speed), closes(-rate, still_rate), near(distance));
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

/// What is cut at the beginning may be short, but not so short as to be no phase at all: a filter
/// that starts looks like a hand that moves. It belongs to the phase that follows.
void join_short_beginning(std::vector<Stretch>& stretches, const SemiMarkovOptions& model) {
  if (stretches.size() < 2) return;
  const Stretch& first = stretches.front();
  if (first.end - first.begin >= model.min_length[first.state]) return;
  stretches[1].begin = first.begin;
  stretches.erase(stretches.begin());
}

/// The object that was nearest most of the time.
std::optional<std::size_t> object_of(const std::vector<Nearest>& nearest, const Stretch& stretch) {
  std::vector<int> counts;
  for (Eigen::Index t = stretch.begin; t < stretch.end; ++t) {
    const auto object = nearest[static_cast<std::size_t>(t)].object;
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
  const auto nearest = nearest_objects(samples);
  const SemiMarkovOptions model = model_of(options, period);
  auto path = decode(Scores(options).of(signals_of(samples, nearest, options.window)), model);
  if (!path) return tl::unexpected(path.error());
  join_short_beginning(path->stretches, model);
  std::vector<Segment> made;
  for (const Stretch& stretch : path->stretches) {
    const Phase phase = phases[static_cast<std::size_t>(stretch.state)];
    const bool has_object =
        phase == Phase::close || phase == Phase::hold || phase == Phase::release;
    const double begin = samples[static_cast<std::size_t>(stretch.begin)].t;
    if (!made.empty()) made.back().end = begin;
    made.push_back(
        {phase, begin, samples.back().t, has_object ? object_of(nearest, stretch) : std::nullopt});
  }
  return made;
}

}  // namespace prehend::demonstration
