#include "services/recorder/tools/dataset_options/dataset_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

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
  app.add_option("--hand", options.hand, "which one, where several are recorded")->group(group);
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
  add("--hand", options.hand);
  add("--task", options.task);
  all.emplace_back("--");
  all.insert(all.end(), options.sources.begin(), options.sources.end());
  return all;
}

Expected<void> check(const DatasetOptions& options) {
  if (options.output.empty())
    return wrong_use("no place to write to", options.format, "name it with -o");
  if (!(options.rate >= min_rate && options.rate <= max_rate))
    return wrong_use("out of range", fmt::format("--rate {}", options.rate),
                     fmt::format("{} to {} Hz", min_rate, max_rate));
  if (options.format.starts_with("lerobot") && options.rate != std::floor(options.rate))
    return wrong_use("LeRobot wants whole rows a second", fmt::format("--rate {}", options.rate));
  if (const auto size = picture_size(options); !size) return tl::unexpected(size.error());
  return {};
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
