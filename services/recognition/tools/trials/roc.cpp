#include "services/recognition/tools/trials/roc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/gnuplot.hpp"

namespace prehend::recognition {

RocPoint roc_at(double threshold, const std::vector<TrialResult>& results) {
  int targets = 0, detected = 0, alarms = 0;
  for (const TrialResult& r : results) {
    targets += !r.target.empty();
    detected += r.probability >= threshold;
    alarms += std::any_of(r.false_alarms.begin(), r.false_alarms.end(),
                          [&](const auto& alarm) { return alarm.probability >= threshold; });
  }
  return {static_cast<double>(detected) / std::max(1, targets),
          static_cast<double>(alarms) / std::max(1.0, static_cast<double>(results.size()))};
}

Expected<void> draw_roc(const std::vector<TrialResult>& results, const std::filesystem::path& png) {
  std::set<double> thresholds;
  for (const TrialResult& r : results) {
    if (r.probability > 0) thresholds.insert(r.probability);
    for (const Sighting& alarm : r.false_alarms) thresholds.insert(alarm.probability);
  }
  // The share of alarms spans decades; none at all stands where half a frame would.
  const double none = 50 / std::max(1.0, static_cast<double>(results.size()));
  double least = 100, most = 10 * none;
  std::string curve, named;
  for (const double threshold : thresholds) {
    const RocPoint at = roc_at(threshold, results);
    curve += fmt::format("{} {}\n", std::max(none, 100 * at.alarms), 100 * at.detected);
  }
  // Thresholds of one point share its label.
  for (std::size_t i = 0; i < roc_thresholds.size(); ++i) {
    const auto same = [&](double threshold) {
      const RocPoint a = roc_at(roc_thresholds[i], results), b = roc_at(threshold, results);
      return a.detected == b.detected && a.alarms == b.alarms;
    };
    const std::size_t first = i;
    while (i + 1 < roc_thresholds.size() && same(roc_thresholds[i + 1])) ++i;
    const RocPoint at = roc_at(roc_thresholds[first], results);
    named += fmt::format("{} {} \"{:.2f}{}\"\n", std::max(none, 100 * at.alarms), 100 * at.detected,
                         roc_thresholds[first],
                         i > first ? fmt::format("–{:.2f}", roc_thresholds[i]) : "");
    least = std::min(least, 100 * at.detected);
    most = std::max(most, 100 * at.alarms);
  }
  return draw_by_gnuplot(
      fmt::format(
          "$curve << EOD\n{}EOD\n$named << EOD\n{}EOD\n"
          "set xlabel 'frames with a false alarm, % (at the left edge: none of {})'\n"
          "set ylabel 'targets detected, %'\n"
          "set grid\nset key off\nset logscale x\n"
          "set xrange [{}:{}]\nset yrange [{}:100]\n"
          "plot $curve using 1:2 with lines lw 2, $named using 1:2 with points pt 7 ps 0.8, "
          "$named using 1:2:3 with labels left offset 0.8,-0.6\n",
          curve, named, results.size(), none, 2 * most, std::floor(least) - 1),
      png, 800, 480);
}

}  // namespace prehend::recognition
