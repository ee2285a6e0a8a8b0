#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/terminal.hpp"
#include "common/base/to_terminal.hpp"
#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/mcap/record_stream.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/copy.hpp"

namespace prehend::recorder {
namespace {

struct EditArguments {
  std::vector<std::string> files;
  std::string to;
  double from_s = 0;
  double until_s = INFINITY;
  std::vector<std::string> topics;
  std::string compression = "zstd";
  bool json = false;
};

void add_common(CLI::App& command, EditArguments& arguments) {
  command.add_option("-o,--output", arguments.to, "recording to write")->required();
  command.add_option("--compression", arguments.compression, "of its chunks")
      ->check(CLI::IsMember({"none", "lz4", "zstd"}))
      ->capture_default_str();
  command.add_flag("--json", arguments.json, "one JSON document");
}

std::function<void(double)> progress_bar() {
  if (!has_cursor(STDERR_FILENO) || log::format() == log::Format::json) return {};
  return [shown = -1](double share) mutable {
    const int percent = static_cast<int>(100 * share);
    if (percent == shown) return;
    shown = percent;
    const auto done = static_cast<std::size_t>(percent * 40 / 100);
    fmt::print(stderr, "\r[{}{}] {:3} %{}", std::string(done, '='), std::string(40 - done, ' '),
               percent, percent == 100 ? "\n" : "");
    std::fflush(stderr);
  };
}

/// Log time of a moment, given from the start of the recordings; far away is the end of time.
std::uint64_t moment(std::uint64_t start, double seconds) {
  if (seconds <= 0) return 0;
  if (seconds > 1e9) return std::numeric_limits<std::uint64_t>::max();
  return start + static_cast<std::uint64_t>(std::llround(seconds * 1e9));
}

/// The recordings of `files` into one.
int run(const EditArguments& arguments) {
  std::vector<recording::mcap::Reader> sources;
  std::uint64_t start = std::numeric_limits<std::uint64_t>::max(), end = 0;
  for (const std::string& file : arguments.files) {
    auto reader = recording::mcap::Reader::open(file);
    if (!reader) return complain_of(file, reader.error());
    const recording::mcap::Statistics& statistics = reader->statistics();
    if (statistics.message_count > 0) start = std::min(start, statistics.message_start_time);
    if (!arguments.topics.empty() && matching(arguments.topics, reader->contents()).empty())
      return complain(no_such_topic(arguments.topics, file), exit_no);
    end = std::max(end, statistics.message_end_time);
    sources.push_back(std::move(*reader));
  }
  if (!(arguments.from_s <= arguments.until_s))
    return complain({"ends before it begins",
                     fmt::format("--from {} --until {}", arguments.from_s, arguments.until_s),
                     "give seconds after the recording's start"},
                    exit_wrong_use);
  if (arguments.from_s > 0 && end >= start && moment(start, arguments.from_s) > end)
    log::warning(Error{
        fmt::format("ends after {:.3f} s, before --from", static_cast<double>(end - start) * 1e-9),
        arguments.files.front(),
        "the part holds only the last words of what stays true, as scene/state"});
  CopyOptions options{.progress = progress_bar()};
  options.writer.compression = recording::mcap::compression_named(
                                   arguments.compression == "none" ? "" : arguments.compression)
                                   .value();
  options.selection.start = moment(start, arguments.from_s);
  options.selection.end = moment(start, arguments.until_s);
  // Channels say themselves of which topic they are, so any source's contents will do.
  if (!arguments.topics.empty())
    options.selection.wanted = [&](const recording::mcap::Channel& channel) {
      return matches(arguments.topics,
                     recording::recorded_topic(channel, sources.front().contents()).name);
    };
  auto result = copy(sources, arguments.to, options);
  if (!result) return complain(result.error(), exit_broken);
  // What that tells to do is done here.
  for (Error& error : result->damage)
    if (error.hint == recording::mcap::damage_hint) error.hint.clear();
  for (const Error& error : result->damage) log::warning(error);
  for (const Error& error : result->remarks) log::warning(error);
  if (arguments.json) {
    nlohmann::ordered_json damage = nlohmann::ordered_json::array();
    for (const Error& error : result->damage) damage.push_back(error.message());
    std::cout << nlohmann::ordered_json{{"file", arguments.to},
                                        {"messages", result->messages},
                                        {"damage", damage}}
                     .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  } else {
    to_terminal("{}: {} messages\n", arguments.to, result->messages);
  }
  // Part of the sources is not in what was made.
  return result->damage.empty() ? exit_done : exit_no;
}

}  // namespace

void add_cut(tool::Program& program) {
  auto* command = program.app().add_subcommand("cut", "a part of a recording, by time and topic");
  const auto arguments = std::make_shared<EditArguments>();
  arguments->files.resize(1);
  command->add_option("FILE", arguments->files[0], "recording")->required();
  command->add_option("--from", arguments->from_s, "s after its start");
  command->add_option("--until", arguments->until_s, "s after its start, inclusive");
  command->add_option("--topic", arguments->topics, "only these; * and ? stand for anything");
  add_common(*command, *arguments);
  program.on(*command, [arguments] { return run(*arguments); });
}

void add_merge(tool::Program& program) {
  auto* command = program.app().add_subcommand("merge", "several recordings as one");
  const auto arguments = std::make_shared<EditArguments>();
  command->add_option("FILE", arguments->files, "recordings")->required();
  add_common(*command, *arguments);
  program.on(*command, [arguments] { return run(*arguments); });
}

void add_recover(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "recover", "a whole recording of what is readable in a damaged one");
  const auto arguments = std::make_shared<EditArguments>();
  arguments->files.resize(1);
  command->add_option("FILE", arguments->files[0], "recording")->required();
  add_common(*command, *arguments);
  program.on(*command, [arguments] { return run(*arguments); });
}

}  // namespace prehend::recorder
