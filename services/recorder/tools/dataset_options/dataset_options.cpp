#include "services/recorder/tools/dataset_options/dataset_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <set>

#include "common/base/finite_number.hpp"

namespace prehend::recorder {
namespace {

constexpr double min_rate = 1, max_rate = 1000;    // Hz
constexpr int min_extent = 16, max_extent = 4096;  // px

}  // namespace

const std::vector<std::string>& dataset_formats() {
  static const std::vector<std::string> formats{"robomimic", "aloha", "lerobot", "lerobot-v2.1"};
  return formats;
}

void add_dataset_options(CLI::App& app, DatasetOptions& options) {
  const std::string group = "Training data";
  app.add_option("--rate", options.rate, "rows a second")->capture_default_str()->group(group);
  app.add_option("--turns", options.turns, "how orientations are written")
      ->check(CLI::IsMember({"quaternion", "columns"}))
      ->capture_default_str()
      ->group(group);
  app.add_option("--size", options.size, "of pictures, as 84x84; without it as recorded")
      ->group(group);
  app.add_option("--hand", options.hands,
                 "which one, where several are recorded, or all side by side: left,right")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--columns", options.columns,
                 "a file that says which fields of which topics are columns: for recordings of "
                 "others")
      ->group(group);
  app.add_option("--episode", options.episodes,
                 "FROM..TO in seconds after the recording's begin; may be repeated; without it "
                 "they are found")
      ->type_size(1)
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--split", options.split, "parts of the episodes by name, as train=0.8,valid=0.2")
      ->group(group);
  app.add_option("--split-seed", options.split_seed, "draws which episode is in which part")
      ->capture_default_str()
      ->group(group);
  app.add_option("--task", options.task, "the task's words; without them as recorded")
      ->group(group);
}

std::vector<std::string> to_arguments(const DatasetOptions& options) {
  std::vector<std::string> all{"--format",     options.format, "--output",
                               options.output, "--rate",       fmt::format("{}", options.rate),
                               "--turns",      options.turns};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) all.insert(all.end(), {name, value});
  };
  add("--size", options.size);
  for (const std::string& hand : options.hands) add("--hand", hand);
  add("--task", options.task);
  add("--columns", options.columns);
  for (const std::string& episode : options.episodes) add("--episode", episode);
  add("--split", options.split);
  add("--split-seed", std::to_string(options.split_seed));
  all.emplace_back("--");
  all.insert(all.end(), options.sources.begin(), options.sources.end());
  return all;
}

Expected<void> check(const DatasetOptions& options) {
  if (options.output.empty())
    return wrong_use("nowhere to write to", options.format, "give the output with -o PATH");
  if (!(options.rate >= min_rate && options.rate <= max_rate))
    return wrong_use("out of range", fmt::format("--rate {}", options.rate),
                     fmt::format("{} to {} Hz", min_rate, max_rate));
  if (options.format.starts_with("lerobot") && options.rate != std::floor(options.rate))
    return wrong_use("LeRobot wants whole rows a second", fmt::format("--rate {}", options.rate));
  if (const auto size = picture_size(options); !size) return tl::unexpected(size.error());
  if (const auto times = given_times(options); !times) return tl::unexpected(times.error());
  const std::set<std::string> hands(options.hands.begin(), options.hands.end());
  if (hands.contains("") || hands.size() < options.hands.size())
    return wrong_use("must name each hand once", "--hand", "as --hand left,right");
  if (!options.columns.empty() && !hands.empty())
    return wrong_use("is for our own topics", "--hand", "--columns names topics");
  return {};
}

Expected<std::vector<std::pair<double, double>>> given_times(const DatasetOptions& options) {
  constexpr double max_time = 1e6;  // s
  std::vector<std::pair<double, double>> times;
  for (const std::string& text : options.episodes) {
    const std::size_t dots = text.find("..");
    const auto from = finite_number(std::string_view(text).substr(0, dots));
    const auto to = dots == std::string::npos
                        ? std::nullopt
                        : finite_number(std::string_view(text).substr(dots + 2));
    if (!from || !to || !(*from >= 0 && *from < *to && *to <= max_time))
      return wrong_use("is no part of a recording", "--episode " + text,
                       "FROM..TO, seconds after its begin, as 2.5..10");
    times.emplace_back(*from, *to);
  }
  return times;
}

Expected<std::optional<std::pair<int, int>>> picture_size(const DatasetOptions& options) {
  if (options.size.empty()) return std::nullopt;
  int width = 0, height = 0;
  const char* const end = options.size.data() + options.size.size();
  const auto first = std::from_chars(options.size.data(), end, width);
  const bool more = first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x';
  const auto second = std::from_chars(more ? first.ptr + 1 : end, end, height);
  if (!more || second.ec != std::errc{} || second.ptr != end ||
      std::min(width, height) < min_extent || std::max(width, height) > max_extent)
    return wrong_use("is no size of pictures", "--size " + options.size,
                     fmt::format("WIDTHxHEIGHT, each {} to {}", min_extent, max_extent));
  return std::pair(width, height);
}

}  // namespace prehend::recorder
