#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/statistics/intervals.hpp"

namespace prehend::mapping {

struct ChartPoint {
  double x = 0;
  statistics::Interval y;
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points;
};

/// Means with their intervals, as lines over numbers or beside each other over names.
struct Chart {
  std::string x_label, y_label;
  std::vector<std::string> names;  // of x = 0, 1, …; empty: x is a number
  bool log_x = false, log_y = false;
  std::vector<ChartSeries> series;
};

/// A line a point: series, x, mean, ci95_low, ci95_high, count.
std::string to_csv(const Chart& chart);

/// Draws it as PNG by gnuplot.
Expected<void> draw(const Chart& chart, const std::filesystem::path& png);

}  // namespace prehend::mapping
