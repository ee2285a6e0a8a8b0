#include "common/statistics/intervals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::statistics {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double min_factor = 1e-12;

/// Probability that a Student variable lies in (-t, t).
double student_within(double t, std::size_t freedom) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(freedom)));
  const double c = std::cos(angle), s = std::sin(angle);
  const bool odd = freedom % 2 == 1;
  double sum = 0, term = odd ? c : 1;
  for (std::size_t k = odd ? 2 : 1; k < freedom; k += 2) {
    sum += term;
    term *= c * c * static_cast<double>(k) / static_cast<double>(k + 1);
  }
  return odd ? (angle + s * sum) * 2 / std::numbers::pi : s * sum;
}

std::vector<double> finite(std::span<const double> samples) {
  std::vector<double> kept;
  for (const double x : samples)
    if (std::isfinite(x)) kept.push_back(x);
  return kept;
}

double mean(std::span<const double> samples) {
  double sum = 0;
  for (const double x : samples) sum += x;
  return sum / static_cast<double>(samples.size());
}

}  // namespace

double student_95(std::size_t freedom) {
  double low = 1, high = 13;  // from infinitely many to one degree
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (student_within(middle, freedom) < 0.95 ? low : high) = middle;
  }
  return low;
}

double deviation(std::span<const double> samples) {
  const std::vector<double> kept = finite(samples);
  if (kept.size() < 2) return 0;
  const double m = mean(kept);
  double sum = 0;
  for (const double x : kept) sum += (x - m) * (x - m);
  return std::sqrt(sum / static_cast<double>(kept.size() - 1));
}

Interval mean_interval(std::span<const double> samples) {
  const std::vector<double> kept = finite(samples);
  const std::size_t n = kept.size();
  if (n == 0) return {std::numeric_limits<double>::quiet_NaN(), -infinity, infinity, 0};
  const double m = mean(kept);
  if (n == 1) return {m, -infinity, infinity, 1};
  const double half = student_95(n - 1) * deviation(kept) / std::sqrt(static_cast<double>(n));
  return {m, m - half, m + half, n};
}

Interval paired_difference(std::span<const double> a, std::span<const double> b) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) differences.push_back(a[i] - b[i]);
  return mean_interval(differences);
}

Interval geometric_mean(std::span<const double> samples) {
  std::vector<double> logarithms;
  for (const double x : samples) logarithms.push_back(std::log(std::max(x, min_factor)));
  const Interval mean = mean_interval(logarithms);
  return {std::exp(mean.mean), std::exp(mean.low), std::exp(mean.high), mean.count};
}

Interval paired_ratio(std::span<const double> a, std::span<const double> b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    ratios.push_back(std::max(a[i], min_factor) / std::max(b[i], min_factor));
  return geometric_mean(ratios);
}

Interval share_interval(std::size_t k, std::size_t n) {
  if (n == 0) return {std::numeric_limits<double>::quiet_NaN(), 0, 1, 0};
  constexpr double z = 1.959963984540054;
  const double count = static_cast<double>(n), p = static_cast<double>(k) / count;
  const double scale = 1 + z * z / count;
  const double centre = (p + z * z / (2 * count)) / scale;
  const double half = z / scale * std::sqrt(p * (1 - p) / count + z * z / (4 * count * count));
  return {p, std::max(0.0, centre - half), std::min(1.0, centre + half), n};
}

Interval deviation_ratio(std::span<const double> a, std::span<const double> b) {
  std::vector<double> first, second;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) {
      first.push_back(a[i]);
      second.push_back(b[i]);
    }
  const std::size_t n = first.size();
  if (n < 2 || deviation(second) == 0)
    return {std::numeric_limits<double>::quiet_NaN(), -infinity, infinity, n};
  constexpr std::size_t resamples = 2000;
  Random random(n);
  std::vector<double> ratios, x(n), y(n);
  for (std::size_t i = 0; i < resamples; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t drawn = random.index(n);
      x[k] = first[drawn];
      y[k] = second[drawn];
    }
    const double below = deviation(y);
    ratios.push_back(below > 0 ? deviation(x) / below : infinity);
  }
  std::sort(ratios.begin(), ratios.end());
  return {deviation(first) / deviation(second), ratios[resamples / 40],
          ratios[resamples - resamples / 40 - 1], n};
}

}  // namespace prehend::statistics
