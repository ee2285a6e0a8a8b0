#include "services/mapping/tools/judging/benchmark_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace prehend::mapping {

namespace {

bool same(const BenchmarkedMode& a, const BenchmarkedMode& b) {
  return a.mode == b.mode && a.placement == b.placement;
}

statistics::Interval mean_of(const std::vector<const TrialResult*>& trials,
                             double TrialResult::*value) {
  std::vector<double> values;
  for (const TrialResult* trial : trials) values.push_back(trial->*value);
  return statistics::mean_interval(values);
}

statistics::Interval held_of(const std::vector<const TrialResult*>& trials,
                             bool demonstrated_only) {
  std::size_t held = 0, all = 0;
  for (const TrialResult* trial : trials) {
    if (demonstrated_only && !trial->demonstrated_held) continue;
    ++all;
    held += trial->held;
  }
  return statistics::share_interval(held, all);
}

std::string percent(const statistics::Interval& share) {
  if (share.count == 0) return "–";
  return fmt::format("{:.1f} % [{:.1f}, {:.1f}]", 100 * share.mean, 100 * share.low,
                     100 * share.high);
}

}  // namespace

std::vector<ModeSummary> summarise(const std::vector<TrialResult>& trials) {
  std::vector<ModeSummary> summaries;
  for (const TrialResult& first : trials) {
    if (std::any_of(summaries.begin(), summaries.end(), [&](const ModeSummary& summary) {
          return summary.hand == first.hand && same(summary.mode, first.mode);
        }))
      continue;
    std::vector<const TrialResult*> mine, real;
    std::map<int, bool> direct;  // held, by take
    for (const TrialResult& trial : trials) {
      if (trial.hand != first.hand) continue;
      if (same(trial.mode, first.mode)) (trial.real ? real : mine).push_back(&trial);
      if (same(trial.mode, {BenchmarkMode::direct})) direct[trial.take] = trial.held;
    }
    std::vector<double> here, there;
    for (const TrialResult* trial : mine)
      if (const auto found = direct.find(trial->take);
          found != direct.end() && trial->demonstrated_held) {
        here.push_back(trial->held);
        there.push_back(found->second);
      }
    summaries.push_back(
        {first.hand, first.mode, held_of(mine, false), held_of(mine, true),
         statistics::paired_difference(here, there), mean_of(mine, &TrialResult::joint_error),
         mean_of(mine, &TrialResult::fingertip_error), mean_of(mine, &TrialResult::epsilon),
         mean_of(mine, &TrialResult::penetration), held_of(real, true)});
  }
  return summaries;
}

std::string to_csv(const std::vector<TrialResult>& trials) {
  std::string csv =
      "hand,mode,placement,take,user,object,grasp_type,demonstrated_held,held,joint_error_rad2,"
      "fingertip_error_m,epsilon,penetration_m,reason,real\n";
  for (const TrialResult& trial : trials)
    csv += fmt::format("{},{},{},{},\"{}\",\"{}\",{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},\"{}\",{}\n",
                       trial.hand, to_string(trial.mode.mode), trial.mode.placement, trial.take,
                       trial.user, trial.object, trial.grasp_type, trial.demonstrated_held,
                       trial.held, trial.joint_error, trial.fingertip_error, trial.epsilon,
                       trial.penetration, trial.reason, trial.real);
  return csv;
}

std::vector<std::vector<std::string>> to_rows(const std::vector<ModeSummary>& summaries) {
  std::vector<std::vector<std::string>> rows{
      {"hand", "mode", "placement", "takes", "held", "held where the demonstrated grasp is",
       "above direct, points", "joint error, rad²", "fingertip error, mm", "ε", "penetration, mm"}};
  const bool real =
      std::ranges::any_of(summaries, [](const auto& one) { return one.real_held.count > 0; });
  if (real) rows.front().push_back("held, real people");
  for (const ModeSummary& one : summaries) {
    const bool compared = one.above_direct.count > 1 && one.mode.mode != BenchmarkMode::direct;
    rows.push_back({one.hand, std::string(to_string(one.mode.mode)),
                    one.mode.placement ? "yes" : "no", std::to_string(one.held.count),
                    percent(one.held), percent(one.held_of_demonstrated),
                    compared ? fmt::format("{:+.1f} [{:.1f}, {:.1f}]", 100 * one.above_direct.mean,
                                           100 * one.above_direct.low, 100 * one.above_direct.high)
                             : "–",
                    fmt::format("{:.3g}", one.joint_error.mean),
                    fmt::format("{:.1f}", 1000 * one.fingertip_error.mean),
                    fmt::format("{:.3f}", one.epsilon.mean),
                    fmt::format("{:.2f}", 1000 * one.penetration.mean)});
    if (real) rows.back().push_back(percent(one.real_held));
  }
  return rows;
}

std::string to_table(const std::vector<ModeSummary>& summaries) {
  std::string text;
  const auto rows = to_rows(summaries);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += fmt::format("| {} |\n", fmt::join(rows[i], " | "));
    if (i > 0) continue;
    for (std::size_t k = 0; k < rows[0].size(); ++k) text += "|---";
    text += "|\n";
  }
  return text;
}

}  // namespace prehend::mapping
