#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

namespace prehend::mapping {

/// One part of a benchmark that is shared by machines: every count-th take from the index-th on,
/// with all hands and modes.
struct ShardNumber {
  int index = 1, count = 1;

  bool has(int take) const { return take % count == index - 1; }
};
/// «2/4»
Expected<ShardNumber> parse_shard(std::string_view text);
std::string to_string(const ShardNumber& number);

/// One take answered by one mode; no result where no person's hand fits around the object.
struct BenchmarkPiece {
  int stage = 0;  // which hand and mode, counted through the benchmark
  int take = 0;
  std::optional<TrialResult> result;
};

/// A shard so far as it has come. Its settings say of which benchmark: shards with the same ones
/// belong together.
struct BenchmarkShard {
  using Settings = std::vector<std::pair<std::string, std::string>>;
  Settings settings;
  ShardNumber number;
  std::size_t pieces = 0;  // that there are when it is done
  std::vector<BenchmarkPiece> done;

  bool is_complete() const { return done.size() == pieces; }
  bool has(int stage, int take) const;
  /// «seed 2, not 1»: the first setting that is another there; empty: none.
  std::string difference(const Settings& others) const;
};

/// «shard-2-of-4.shard» in a folder.
std::filesystem::path shard_file(const std::filesystem::path& folder, const ShardNumber& number);

/// As a sealed file of kind «benchmark-shard». The same pieces make the same bytes, in whatever
/// order they came. Whoever reads meanwhile sees the file as it was before, or as it is.
Expected<void> save_shard(const std::filesystem::path& file, const BenchmarkShard& shard);
Expected<BenchmarkShard> load_shard(const std::filesystem::path& file);

struct MergedBenchmark {
  BenchmarkShard::Settings settings;
  std::vector<TrialResult> trials;  // in the order of one run
};

/// What one run would have given. Refuses shards that are missing, doubled, not done or of another
/// benchmark, and says which.
Expected<MergedBenchmark> merge_shards(const std::vector<std::filesystem::path>& files);

/// How far one shard is.
struct ShardProgress {
  ShardNumber number;
  bool begun = false;  // it has a file, which says the rest
  std::size_t done = 0, pieces = 0;

  bool is_complete() const { return begun && done == pieces; }
};

/// Of all shards whose files lie in a folder, and of those that are still missing there. Refuses a
/// folder without any, and shards of different benchmarks.
Expected<std::vector<ShardProgress>> shard_progress(const std::filesystem::path& folder);

}  // namespace prehend::mapping
