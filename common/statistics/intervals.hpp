#pragma once

#include <cstddef>
#include <span>

namespace prehend::statistics {

/// A mean with its 95 % confidence interval.
struct Interval {
  double mean = 0, low = 0, high = 0;
  std::size_t count = 0;  // of samples
};

/// t for which a Student variable of `freedom` degrees (1 or more) lies in (-t, t) with 95 %, from
/// the closed form of its distribution (Abramowitz and Stegun, 26.7.3 and 26.7.4).
double student_95(std::size_t freedom);

/// Of independent samples by Student's t; what is not finite is left out. With fewer than two the
/// interval is everything.
Interval mean_interval(std::span<const double> samples);

/// Of a[i] − b[i], pairs of the same repetition; pairs that are not finite are left out.
Interval paired_difference(std::span<const double> a, std::span<const double> b);

/// Geometric mean: errors of training spread over orders of magnitude, and an arithmetic mean would
/// be that of the worst few. Numbers below 1e-12 count as that; what is not finite is left out.
Interval geometric_mean(std::span<const double> samples);

/// Geometric mean of a[i] / b[i], pairs of the same repetition.
Interval paired_ratio(std::span<const double> a, std::span<const double> b);

/// Of a share, k of n, by Wilson's score [Wilson1927]; everything for n = 0.
Interval share_interval(std::size_t k, std::size_t n);

/// Standard deviation of what is finite (n − 1); 0 for fewer than two.
double deviation(std::span<const double> samples);

/// Of deviation(a) / deviation(b): bootstrap over pairs, percentiles of 2000 resamples that follow
/// from a fixed seed.
Interval deviation_ratio(std::span<const double> a, std::span<const double> b);

}  // namespace prehend::statistics
