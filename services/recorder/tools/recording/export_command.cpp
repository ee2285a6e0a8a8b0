#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/recording/compare/recorded_topic.hpp"
#include "services/recorder/tools/dataset_options/dataset_options.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/table.hpp"

namespace prehend::recorder {
namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
  std::string file;
  std::string folder;  // empty: standard output
  std::string format = "csv";
  std::vector<std::string> topics;
  DatasetOptions dataset;
};

/// Training data are written by a program of their own, because of the libraries that it loads.
/// Returns only where it is not there.
int become_dataset(const DatasetOptions& options) {
  std::vector<std::string> command{(program_directory() / "prehend-dataset").string()};
  for (std::string& argument : to_arguments(options)) command.push_back(std::move(argument));
  std::vector<char*> pointers;
  for (std::string& argument : command) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(pointers.front(), pointers.data());
  return complain({std::strerror(errno), command.front(), "it is in the package prehend-vision"},
                  exit_broken);
}

/// glove/frame in CSV is glove-frame.csv.
std::filesystem::path file_name(const ExportArguments& arguments, std::string topic) {
  std::ranges::replace(topic, '/', '-');
  return std::filesystem::path(arguments.folder) / (topic + "." + arguments.format);
}

class Export {
 public:
  Export(const ExportArguments& arguments, recording::mcap::Reader& reader)
      : arguments_(arguments), reader_(reader), types_(reader) {}

  int run() {
    bool damaged = false;
    auto cursor = reader_.messages({.wanted = [&](const recording::mcap::Channel& channel) {
      const auto topic = recording::recorded_topic(channel, reader_.contents());
      return topic.end.empty() && matches(arguments_.topics, topic.name);
    }});
    while (true) {
      const auto next = cursor.next();
      if (!next) {
        log::error(next.error());
        damaged = true;
        continue;
      }
      if (!*next) break;
      if (auto done = write(**next); !done) return complain(done.error(), exit_broken);
    }
    for (const auto& [topic, count] : undecoded_)
      log::warning("{}: {} messages could not be decoded", topic, count);
    return damaged || !undecoded_.empty() ? exit_no : exit_done;
  }

 private:
  Expected<void> write(const recording::mcap::ReadMessage& read) {
    const auto& [channel, message] = read;
    const std::string topic = recording::recorded_topic(*channel, reader_.contents()).name;
    const recording::types::Structure* type = types_.of(*channel);
    const auto value = type ? recording::types::decode(*type, message.data)
                            : Expected<recording::types::Value>(fail("its type is not described"));
    if (!value) {
      ++undecoded_[topic];
      return {};
    }
    const auto out = stream(topic, *type);
    if (!out) return tl::unexpected(out.error());
    if (arguments_.format == "csv") {
      **out << message.log_time << ',' << message.publish_time << ',' << message.sequence;
      for (const std::string& cell : cells(*type, *value)) **out << ',' << cell;
      **out << '\n';
    } else {
      **out << Json{{"topic", topic},
                    {"log_time_ns", message.log_time},
                    {"publish_time_ns", message.publish_time},
                    {"sequence", message.sequence},
                    {"message", recording::types::to_json(*value)}}
                   .dump(-1, ' ', false, Json::error_handler_t::replace)
            << '\n';
    }
    if (!**out) return fail("cannot be written", file_name(arguments_, topic).string());
    return {};
  }

  /// Where the topic's rows go; a table begins with its heading.
  Expected<std::ostream*> stream(const std::string& topic,
                                 const recording::types::Structure& type) {
    const bool fresh = begun_.insert(topic).second;
    std::ostream* out = &std::cout;
    if (!arguments_.folder.empty()) {
      std::ofstream& file = files_[topic];
      if (fresh) file.open(file_name(arguments_, topic));
      if (!file) return fail("cannot be written", file_name(arguments_, topic).string());
      out = &file;
    }
    if (fresh && arguments_.format == "csv") {
      *out << "log_time_ns,publish_time_ns,sequence";
      for (const std::string& column : columns(type)) *out << ',' << column;
      *out << '\n';
    }
    return out;
  }

  const ExportArguments& arguments_;
  recording::mcap::Reader& reader_;
  recording::RecordedTypes types_;
  std::set<std::string> begun_;
  std::map<std::string, std::ofstream> files_;
  std::map<std::string, std::uint64_t> undecoded_;
};

int run_tables(const ExportArguments& arguments) {
  auto reader = recording::mcap::Reader::open(arguments.file);
  if (!reader) return complain_of(arguments.file, reader.error());
  const auto topics = matching(arguments.topics, reader->contents());
  if (topics.empty()) return complain(no_such_topic(arguments.topics, arguments.file), exit_no);
  if (arguments.folder.empty() && arguments.format == "csv" && topics.size() > 1)
    return complain({"a table holds one topic", fmt::format("{} topics", topics.size()),
                     "choose one with --topic, or a folder for all with -o"},
                    exit_wrong_use);
  if (!arguments.folder.empty()) {
    std::error_code problem;
    std::filesystem::create_directories(arguments.folder, problem);
    if (problem) return complain({problem.message(), arguments.folder, ""}, exit_broken);
  }
  return Export(arguments, *reader).run();
}

int run(ExportArguments& arguments) {
  DatasetOptions& dataset = arguments.dataset;
  if (std::ranges::count(dataset_formats(), arguments.format) > 0) {
    dataset.format = arguments.format;
    dataset.output = arguments.folder;
    if (!arguments.topics.empty())
      return complain({"is for tables", "--topic", ""}, exit_wrong_use);
    if (const auto possible = check(dataset); !possible) return complain(possible.error());
    return become_dataset(dataset);
  }
  if (dataset.sources.size() > 1)
    return complain(
        {"tables are made of one recording", fmt::format("{} given", dataset.sources.size()),
         "prehend recording merge makes one of several"},
        exit_wrong_use);
  arguments.file = dataset.sources.front();
  return run_tables(arguments);
}

}  // namespace

void add_export(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "export", "messages as CSV or as lines of JSON; recordings as training data");
  const auto arguments = std::make_shared<ExportArguments>();
  std::vector<std::string> formats{"csv", "jsonl"};
  formats.insert(formats.end(), dataset_formats().begin(), dataset_formats().end());
  command
      ->add_option("FILE", arguments->dataset.sources,
                   "recording; for training data also several, and folders of them")
      ->required();
  command
      ->add_option("--format", arguments->format,
                   "a table a topic (csv), a document a message (jsonl), or training data")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  command->add_option("--topic", arguments->topics, "only these; * and ? stand for anything");
  command->add_option("-o,--output", arguments->folder,
                      "folder for a file a topic, without it standard output; of training data, "
                      "what is made");
  add_dataset_options(*command, arguments->dataset);
  program.on(*command, [arguments] { return run(*arguments); });
}

}  // namespace prehend::recorder
