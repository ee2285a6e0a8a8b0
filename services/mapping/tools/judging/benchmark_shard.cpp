#include "services/mapping/tools/judging/benchmark_shard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>
#include <system_error>
#include <tuple>

#include "common/proto/benchmark_shard.pb.h"
#include "common/proto/sealed_file.hpp"

namespace prehend::mapping {

namespace {

constexpr std::string_view kind = "benchmark-shard";
constexpr int max_shards = 100'000;

messages::BenchmarkTrial to_message(const BenchmarkPiece& piece) {
  messages::BenchmarkTrial to;
  to.set_stage(static_cast<std::uint32_t>(piece.stage));
  to.set_take(static_cast<std::uint32_t>(piece.take));
  to.set_empty(!piece.result);
  if (!piece.result) return to;
  const TrialResult& from = *piece.result;
  to.set_hand(from.hand);
  to.set_mode(std::string(to_string(from.mode.mode)));
  to.set_placement(from.mode.placement);
  to.set_object(from.object);
  to.set_grasp_type(from.grasp_type);
  to.set_user(from.user);
  to.set_demonstrated_held(from.demonstrated_held);
  to.set_joint_error(from.joint_error);
  to.set_fingertip_error(from.fingertip_error);
  to.set_epsilon(from.epsilon);
  to.set_penetration(from.penetration);
  to.set_held(from.held);
  to.set_reason(from.reason);
  return to;
}

std::optional<BenchmarkPiece> from_message(const messages::BenchmarkTrial& from) {
  BenchmarkPiece piece{static_cast<int>(from.stage()), static_cast<int>(from.take()), {}};
  if (from.empty()) return piece;
  const auto mode = benchmark_modes.value(from.mode());
  if (!mode) return std::nullopt;
  TrialResult to;
  to.hand = from.hand();
  to.mode = {*mode, from.placement()};
  to.take = piece.take;
  to.object = from.object();
  to.grasp_type = from.grasp_type();
  to.user = from.user();
  to.demonstrated_held = from.demonstrated_held();
  to.joint_error = from.joint_error();
  to.fingertip_error = from.fingertip_error();
  to.epsilon = from.epsilon();
  to.penetration = from.penetration();
  to.held = from.held();
  to.reason = from.reason();
  piece.result = std::move(to);
  return piece;
}

auto place(const BenchmarkPiece& piece) {
  return std::tie(piece.stage, piece.take);
}

bool in_order(const BenchmarkPiece& a, const BenchmarkPiece& b) {
  return place(a) < place(b);
}

/// What must hold of a file before anything relies on it.
bool is_sound(const BenchmarkShard& shard) {
  const ShardNumber& number = shard.number;
  if (number.count < 1 || number.count > max_shards || number.index < 1 ||
      number.index > number.count || shard.done.size() > shard.pieces)
    return false;
  const auto mine = [&](const BenchmarkPiece& one) { return number.has(one.take); };
  const auto same = [](const auto& a, const auto& b) { return place(a) == place(b); };
  return std::ranges::all_of(shard.done, mine) && std::ranges::is_sorted(shard.done, in_order) &&
         std::ranges::adjacent_find(shard.done, same) == shard.done.end();
}

}  // namespace

Expected<ShardNumber> parse_shard(std::string_view text) {
  ShardNumber number;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, number.index);
  if (index.ec == std::errc() && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, number.count);
    if (count.ec == std::errc() && count.ptr == end && number.index >= 1 &&
        number.index <= number.count && number.count <= max_shards)
      return number;
  }
  return wrong_use(fmt::format("«{}» is no shard", text), "--shard", "from 1/N to N/N");
}

std::string to_string(const ShardNumber& number) {
  return fmt::format("{}/{}", number.index, number.count);
}

bool BenchmarkShard::has(int stage, int take) const {
  return std::ranges::any_of(
      done, [&](const BenchmarkPiece& one) { return one.stage == stage && one.take == take; });
}

std::string BenchmarkShard::difference(const Settings& others) const {
  const std::map<std::string, std::string> mine(settings.begin(), settings.end());
  for (const auto& [name, value] : others) {
    const auto found = mine.find(name);
    const std::string here = found == mine.end() ? "none" : found->second;
    if (here != value) return fmt::format("{} {}, not {}", name, here, value);
  }
  return settings.size() == others.size() ? "" : "more settings";
}

std::filesystem::path shard_file(const std::filesystem::path& folder, const ShardNumber& number) {
  return folder / fmt::format("shard-{}-of-{}.shard", number.index, number.count);
}

Expected<void> save_shard(const std::filesystem::path& file, const BenchmarkShard& shard) {
  messages::BenchmarkShard message;
  for (const auto& [name, value] : shard.settings) {
    messages::BenchmarkSetting& setting = *message.add_settings();
    setting.set_name(name);
    setting.set_value(value);
  }
  message.set_index(static_cast<std::uint32_t>(shard.number.index));
  message.set_count(static_cast<std::uint32_t>(shard.number.count));
  message.set_pieces(static_cast<std::uint32_t>(shard.pieces));
  std::vector<const BenchmarkPiece*> sorted;
  for (const BenchmarkPiece& piece : shard.done) sorted.push_back(&piece);
  std::ranges::sort(sorted, [](auto* a, auto* b) { return in_order(*a, *b); });
  for (const BenchmarkPiece* piece : sorted) *message.add_trials() = to_message(*piece);
  return proto::write_sealed(file, kind, message.SerializeAsString());
}

Expected<BenchmarkShard> load_shard(const std::filesystem::path& file) {
  const std::string hint = "run this shard again";
  const auto bytes = proto::read_sealed(file, kind);
  if (!bytes) return fail(bytes.error().what, file.string(), hint);
  messages::BenchmarkShard message;
  if (!message.ParseFromString(*bytes)) return fail("holds no shard", file.string(), hint);
  BenchmarkShard shard;
  for (const messages::BenchmarkSetting& setting : message.settings())
    shard.settings.emplace_back(setting.name(), setting.value());
  shard.number = {static_cast<int>(message.index()), static_cast<int>(message.count())};
  shard.pieces = message.pieces();
  for (const messages::BenchmarkTrial& trial : message.trials()) {
    auto piece = from_message(trial);
    if (!piece) return fail("knows a mode that is none", file.string(), hint);
    shard.done.push_back(std::move(*piece));
  }
  if (!is_sound(shard)) return fail("contradicts itself", file.string(), hint);
  return shard;
}

Expected<MergedBenchmark> merge_shards(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) return wrong_use("names no shard", "--merge");
  MergedBenchmark merged;
  std::vector<BenchmarkPiece> pieces;
  std::map<int, std::filesystem::path> given;  // by index
  int count = 0;
  for (const std::filesystem::path& file : files) {
    auto shard = load_shard(file);
    if (!shard) return tl::unexpected(shard.error());
    const std::string number = to_string(shard->number);
    if (given.empty()) {
      merged.settings = shard->settings;
      count = shard->number.count;
    }
    const std::string& first = given.empty() ? file.string() : given.begin()->second.string();
    if (const auto other = shard->difference(merged.settings); !other.empty())
      return fail("is of another benchmark: " + other, file.string(), "compared with " + first);
    if (shard->number.count != count)
      return fail(fmt::format("is shard {}, not one of {}", number, count), file.string(),
                  "compared with " + first);
    const auto [twin, is_new] = given.try_emplace(shard->number.index, file);
    if (!is_new)
      return fail(fmt::format("shard {} is there twice", number), file.string(),
                  "leave out this one or " + twin->second.string());
    if (!shard->is_complete())
      return fail(fmt::format("shard {} is not done: {} of {} takes", number, shard->done.size(),
                              shard->pieces),
                  file.string(), "run it again; it goes on there");
    std::ranges::move(shard->done, std::back_inserter(pieces));
  }
  for (int index = 1; index <= count; ++index)
    if (!given.contains(index))
      return fail(fmt::format("shard {}/{} is missing", index, count),
                  files.front().parent_path().string(), "run it, or name its file");
  std::ranges::sort(pieces, in_order);
  for (BenchmarkPiece& piece : pieces)
    if (piece.result) merged.trials.push_back(std::move(*piece.result));
  return merged;
}

Expected<std::vector<ShardProgress>> shard_progress(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".shard") files.push_back(entry.path());
  if (error) return fail(error.message(), folder.string(), "is the path right?");
  if (files.empty()) return fail("holds no shards", folder.string(), "has none begun?");
  std::ranges::sort(files);
  std::vector<ShardProgress> progress;
  BenchmarkShard::Settings settings;
  for (const std::filesystem::path& file : files) {
    const auto shard = load_shard(file);
    if (!shard) return tl::unexpected(shard.error());
    if (progress.empty()) {
      settings = shard->settings;
      for (int i = 1; i <= shard->number.count; ++i)
        progress.push_back({{i, shard->number.count}, false, 0, 0});
    }
    if (const auto other = shard->difference(settings); !other.empty())
      return fail("is of another benchmark: " + other, file.string(),
                  "compared with " + files.front().string());
    if (shard->number.count != static_cast<int>(progress.size()))
      return fail(
          fmt::format("is shard {}, not one of {}", to_string(shard->number), progress.size()),
          file.string(), "compared with " + files.front().string());
    progress[static_cast<std::size_t>(shard->number.index - 1)] = {
        shard->number, true, shard->done.size(), shard->pieces};
  }
  return progress;
}

}  // namespace prehend::mapping
