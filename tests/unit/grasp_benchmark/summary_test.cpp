// What the grasp benchmark's trials are summed up to, on a few that can be counted by hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "services/mapping/tools/judging/benchmark_summary.hpp"

namespace prehend::mapping {
namespace {

TrialResult trial(BenchmarkMode mode, int take, bool demonstrated, bool held) {
  TrialResult result;
  result.hand = "barrett";
  result.object = "Talc, small";
  result.take = take;
  result.mode = {mode, false};
  result.demonstrated_held = demonstrated;
  result.held = held;
  result.joint_error = take;
  return result;
}

std::vector<TrialResult> trials() {
  using enum BenchmarkMode;
  return {trial(direct, 0, true, false),      trial(direct, 1, true, true),
          trial(direct, 2, true, false),      trial(direct, 3, false, true),
          trial(intelligent, 0, true, true),  trial(intelligent, 1, true, true),
          trial(intelligent, 2, true, false), trial(intelligent, 3, false, false)};
}

TEST(Summary, CountsWhatWasHeld) {
  const auto summaries = summarise(trials());
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].mode.mode, BenchmarkMode::direct);
  EXPECT_DOUBLE_EQ(summaries[0].held.mean, 0.5);
  EXPECT_EQ(summaries[0].held.count, 4u);
  EXPECT_DOUBLE_EQ(summaries[0].held_of_demonstrated.mean, 1.0 / 3);
  EXPECT_DOUBLE_EQ(summaries[1].held_of_demonstrated.mean, 2.0 / 3);
  EXPECT_DOUBLE_EQ(summaries[1].joint_error.mean, 1.5);
}

TEST(Summary, ComparesTheSameTakes) {
  auto all = trials();
  // Whatever the order in which they come.
  std::reverse(all.begin(), all.end());
  for (const ModeSummary& one : summarise(all)) {
    EXPECT_EQ(one.above_direct.count, 3u) << "only where the demonstrated grasp is held";
    EXPECT_DOUBLE_EQ(one.above_direct.mean, one.mode.mode == BenchmarkMode::direct ? 0.0 : 1.0 / 3);
  }
}

TEST(Summary, HasARowForEachModeAndALineForEachTrial) {
  const auto rows = to_rows(summarise(trials()));
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  const std::string csv = to_csv(trials());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 9);
  EXPECT_NE(csv.find("\"Talc, small\""), std::string::npos);
  EXPECT_TRUE(summarise({}).empty());
}

}  // namespace
}  // namespace prehend::mapping
