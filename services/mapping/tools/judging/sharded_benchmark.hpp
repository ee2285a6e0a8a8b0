#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "common/grasping/planner.hpp"
#include "services/mapping/tools/judging/benchmark_shard.hpp"
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

namespace prehend::mapping {

/// What several hands are asked for.
struct BenchmarkRequest {
  std::vector<BenchmarkedHand> hands;
  std::vector<BenchmarkedMode> modes;  // those that a hand does not allow are left out for it
  int takes = 24;                      // of each hand and mode
  std::uint64_t seed = 1;
  bool quick = false;  // as it is called in reports
  TakeOptions take;
};

/// All of it in one run, hand by hand, mode by mode. `progress` is told shares from 0 to 1.
Expected<std::vector<TrialResult>> run_benchmark(const BenchmarkRequest& request,
                                                 const grasping::ForEach& for_each,
                                                 const std::function<void(double)>& progress);

/// One shard of it, kept in a file as it grows: what a killed one has done is not done again. Fails
/// when the file is damaged, or of another benchmark or shard.
Expected<BenchmarkShard> run_shard(const BenchmarkRequest& request, const ShardNumber& number,
                                   const std::filesystem::path& file,
                                   const grasping::ForEach& for_each,
                                   const std::function<void(double)>& progress);

}  // namespace prehend::mapping
