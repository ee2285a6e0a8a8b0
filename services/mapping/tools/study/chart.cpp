#include "services/mapping/tools/study/chart.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/base/gnuplot.hpp"

namespace prehend::mapping {

namespace {

std::string csv_text(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

/// In gnuplot's double quotes; names hold no quotes or backslashes.
std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

}  // namespace

std::string to_csv(const Chart& chart) {
  std::string csv = "series,x,mean,ci95_low,ci95_high,count\n";
  for (const ChartSeries& series : chart.series)
    for (const ChartPoint& point : series.points) {
      const std::string x = chart.names.empty()
                                ? fmt::format("{:.6g}", point.x)
                                : csv_text(chart.names[static_cast<std::size_t>(point.x)]);
      csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{}\n", csv_text(series.name), x, point.y.mean,
                         point.y.low, point.y.high, point.y.count);
    }
  return csv;
}

Expected<void> draw(const Chart& chart, const std::filesystem::path& png) {
  std::string commands = fmt::format(
      "set xlabel {}\nset ylabel {}\nset key outside top center horizontal noenhanced\n"
      "set grid ytics lc rgb '#dddddd'\nset style fill solid 0.6\nset bars 0.6\n",
      quoted(chart.x_label), quoted(chart.y_label));
  if (chart.log_x) commands += "set logscale x\nset format x '%g'\n";
  if (chart.log_y) commands += "set logscale y\nset format y '10^{%T}'\n";
  const bool named = !chart.names.empty();
  if (named) {
    std::string tics;
    for (std::size_t i = 0; i < chart.names.size(); ++i)
      tics += fmt::format("{}{} {}", i > 0 ? ", " : "", quoted(chart.names[i]), i);
    commands += fmt::format("set xtics ({}) noenhanced\nset xrange [-0.6:{}]\n", tics,
                            static_cast<double>(chart.names.size()) - 0.4);
    if (!chart.log_y) commands += "set yrange [0:*]\n";
  }
  const double width = 0.8 / static_cast<double>(std::max<std::size_t>(chart.series.size(), 1));
  std::string plots;
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    commands += fmt::format("$d{} << EOD\n", s);
    const double shift = named ? (static_cast<double>(s) + 0.5) * width - 0.4 : 0;
    for (const ChartPoint& point : chart.series[s].points) {
      if (!std::isfinite(point.y.mean)) continue;
      const bool known = std::isfinite(point.y.low) && std::isfinite(point.y.high);
      double low = known ? point.y.low : point.y.mean, high = known ? point.y.high : point.y.mean;
      if (chart.log_y) low = std::max(low, point.y.mean / 1000);
      commands +=
          fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", point.x + shift, point.y.mean, low, high);
    }
    commands += "EOD\n";
    const std::string_view separator = s > 0 ? ", " : "plot ";
    if (named)
      plots += fmt::format(
          "{0}$d{1} using 1:2:({2}) with boxes lc {3} title {4}, $d{1} using "
          "1:2:3:4 with yerrorbars lc rgb '#444444' pt 0 notitle",
          separator, s, 0.9 * width, s + 1, quoted(chart.series[s].name));
    else
      plots += fmt::format(
          "{0}$d{1} using 1:3:4 with filledcurves lc {2} fs transparent solid "
          "0.15 notitle, $d{1} using 1:2 with lines lc {2} lw 2 title {3}",
          separator, s, s + 1, quoted(chart.series[s].name));
  }
  return draw_by_gnuplot(commands + plots + "\n", png, 800, 480);
}

}  // namespace prehend::mapping
