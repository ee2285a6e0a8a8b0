#pragma once

#include <string>
#include <vector>

#include "common/statistics/intervals.hpp"
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

namespace prehend::mapping {

/// What came of all takes of one hand with one mode. Those of real people count for themselves:
/// where the object was in their hands is a guess.
struct ModeSummary {
  std::string hand;
  BenchmarkedMode mode;
  statistics::Interval held;  // share of all takes of synthetic people
  statistics::Interval
      held_of_demonstrated;  // of those whose demonstrated robot grasp itself survives
  /// Of the same takes and those: share held minus that of direct mapping, which knows nothing
  /// of the object and cannot place the hand by it; count 0 without such takes.
  statistics::Interval above_direct;
  statistics::Interval joint_error;      // rad²
  statistics::Interval fingertip_error;  // m
  statistics::Interval epsilon;          // of the contacts; −1 without force closure
  statistics::Interval penetration;      // m
  statistics::Interval real_held;        // as held_of_demonstrated, of real people
};

/// One a hand and mode, in the order in which they come.
std::vector<ModeSummary> summarise(const std::vector<TrialResult>& trials);

/// A line a take and mode.
std::string to_csv(const std::vector<TrialResult>& trials);

/// Rows of cells, the first one is the header: for Markdown and HTML alike.
std::vector<std::vector<std::string>> to_rows(const std::vector<ModeSummary>& summaries);
/// The same as Markdown.
std::string to_table(const std::vector<ModeSummary>& summaries);

}  // namespace prehend::mapping
