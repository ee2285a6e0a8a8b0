#include "services/mapping/tools/judging/sharded_benchmark.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <system_error>

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"
#include "common/proto/sealed_file.hpp"

namespace prehend::mapping {

namespace {

/// One hand with one mode.
struct Stage {
  const BenchmarkedHand* hand;
  BenchmarkedMode mode;
};

/// Those that the hands allow, in the order of reports. Others than these two are not for every
/// hand.
Expected<std::vector<Stage>> stages(const BenchmarkRequest& request) {
  std::vector<Stage> all;
  for (const BenchmarkedHand& hand : request.hands)
    for (const BenchmarkedMode& mode : request.modes) {
      const auto allowed = check_mode(hand, mode);
      if (allowed)
        all.push_back({&hand, mode});
      else if (mode.mode == BenchmarkMode::direct || mode.mode == BenchmarkMode::intelligent)
        return tl::unexpected(allowed.error());
    }
  return all;
}

GraspBenchmarkOptions of_stage(const Stage& stage, const BenchmarkRequest& request) {
  GraspBenchmarkOptions asked;
  asked.modes = {stage.mode};
  asked.takes = first_takes(request.takes);
  asked.seed += request.seed;
  asked.take = request.take;
  return asked;
}

/// The sources that it was built from; what git does not know is told apart by the program itself.
std::string commit() {
  const auto text = read_file(share_directory() / "commit");
  std::string name = text ? text->substr(0, text->find('\n')) : "unknown";
  if (text && !name.ends_with("-dirty")) return name;
  const auto program = read_file("/proc/self/exe");
  return name + ", program " + (program ? proto::digest(*program).substr(0, 12) : "unknown");
}

std::vector<std::string> names_of(const BenchmarkRequest& request) {
  std::vector<std::string> names;
  for (const BenchmarkedHand& hand : request.hands) names.push_back(hand.hand.name());
  return names;
}

/// All that hands and objects are read from.
std::string data_digest(const BenchmarkRequest& request) {
  const auto share = share_directory();
  std::vector<std::filesystem::path> files{share / "models" / "objects" / "catalogue.toml"};
  for (const std::string& hand : names_of(request)) {
    files.push_back(share / "trained" / (hand + ".grasps"));
    files.push_back(share / "trained" / (hand + ".mapping"));
    files.push_back(model::hand_directory(hand) / "hand.urdf");
    files.push_back(model::hand_directory(hand) / "hand.toml");
  }
  std::string digests;
  for (const BenchmarkedHand& hand : request.hands)
    digests += hand.model.traits().made_for;  // of a user's hand, which lies elsewhere
  for (const std::filesystem::path& file : files)
    digests += proto::digest(read_file(file).value_or(""));
  return proto::digest(digests).substr(0, 12);
}

/// What shards of the same benchmark have in common.
BenchmarkShard::Settings settings_of(const BenchmarkRequest& request) {
  std::vector<std::string> modes;
  for (const BenchmarkedMode& mode : request.modes)
    modes.push_back(fmt::format("{}{}", to_string(mode.mode), mode.placement ? " placed" : ""));
  const TakeOptions& take = request.take;
  return {{"commit", commit()},
          {"data", data_digest(request)},
          {"seed", std::to_string(request.seed)},
          {"quick", request.quick ? "yes" : "no"},
          {"takes", std::to_string(request.takes)},
          {"hands", fmt::format("{}", fmt::join(names_of(request), ", "))},
          {"modes", fmt::format("{}", fmt::join(modes, ", "))},
          {"size error", fmt::format("{}", take.size_error)},
          {"position error", fmt::format("{}", take.position_error)},
          {"claimed error", fmt::format("{}", take.claimed_error)},
          {"late", take.late ? "yes" : "no"}};
}

/// What the file has of this shard; nothing where there is no file.
Expected<BenchmarkShard> begun(const std::filesystem::path& file, const ShardNumber& number,
                               const BenchmarkShard::Settings& settings, std::size_t pieces) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return BenchmarkShard{settings, number, pieces, {}};
  auto shard = load_shard(file);
  if (!shard) return shard;
  const std::string hint = "move it away to begin anew";
  if (const auto other = shard->difference(settings); !other.empty())
    return fail("is of another benchmark: " + other, file.string(), hint);
  if (to_string(shard->number) != to_string(number) || shard->pieces != pieces)
    return fail("is another shard: " + to_string(shard->number), file.string(), hint);
  return shard;
}

/// A shard in its file. Pieces come from one thread at a time.
class ShardFile {
 public:
  ShardFile(std::filesystem::path file, BenchmarkShard shard)
      : file_(std::move(file)), shard_(std::move(shard)) {}

  void add(BenchmarkPiece piece) {
    shard_.done.push_back(std::move(piece));
    // A file on the network is not written for every take.
    const auto now = std::chrono::steady_clock::now();
    if (now - saved_ > std::chrono::seconds(1)) (void)save();
  }
  Expected<void> save() {
    saved_ = std::chrono::steady_clock::now();
    return save_shard(file_, shard_);
  }
  const BenchmarkShard& shard() const { return shard_; }

 private:
  std::filesystem::path file_;
  BenchmarkShard shard_;
  std::chrono::steady_clock::time_point saved_{};
};

}  // namespace

Expected<std::vector<TrialResult>> run_benchmark(const BenchmarkRequest& request,
                                                 const grasping::ForEach& for_each,
                                                 const std::function<void(double)>& progress) {
  const auto asked = stages(request);
  if (!asked) return tl::unexpected(asked.error());
  const double pieces = static_cast<double>(asked->size()) * request.takes;
  double done = 0;
  std::vector<TrialResult> all;
  for (const Stage& stage : *asked) {
    auto trials = run_grasp_benchmark(*stage.hand, of_stage(stage, request), for_each,
                                      [&](auto&&...) { progress(++done / pieces); });
    if (!trials) return trials;
    std::ranges::move(*trials, std::back_inserter(all));
  }
  return all;
}

Expected<BenchmarkShard> run_shard(const BenchmarkRequest& request, const ShardNumber& number,
                                   const std::filesystem::path& file,
                                   const grasping::ForEach& for_each,
                                   const std::function<void(double)>& progress) {
  const auto asked = stages(request);
  if (!asked) return tl::unexpected(asked.error());
  std::vector<int> takes = first_takes(request.takes);
  std::erase_if(takes, [&](int take) { return !number.has(take); });
  const std::size_t pieces = asked->size() * takes.size();
  auto shard = begun(file, number, settings_of(request), pieces);
  if (!shard) return shard;

  ShardFile kept(file, std::move(*shard));
  // A folder that cannot be written is better known before the work than after it.
  if (auto saved = kept.save(); !saved) return tl::unexpected(saved.error());
  for (std::size_t i = 0; i < asked->size(); ++i) {
    const int stage = static_cast<int>(i);
    GraspBenchmarkOptions left = of_stage((*asked)[i], request);
    left.takes = takes;
    std::erase_if(left.takes, [&](int take) { return kept.shard().has(stage, take); });
    const auto trials = run_grasp_benchmark(
        *(*asked)[i].hand, left, for_each,
        [&](const BenchmarkedMode&, int take, const std::optional<TrialResult>& result) {
          kept.add({stage, take, result});
          progress(static_cast<double>(kept.shard().done.size()) / static_cast<double>(pieces));
        });
    if (!trials) return tl::unexpected(trials.error());
  }
  if (auto saved = kept.save(); !saved) return tl::unexpected(saved.error());
  return kept.shard();
}

}  // namespace prehend::mapping
