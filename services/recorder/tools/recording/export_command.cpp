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
#include "common/base/printable.hpp"
#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/messages/message_decoder.hpp"
#include "services/recorder/tools/dataset_options/dataset_options.hpp"
#include "services/recorder/tools/recording/commands.hpp"
#include "services/recorder/tools/recording/export_names.hpp"
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

/// Messages that are in no table, and why.
struct LeftOut {
  std::uint64_t count = 0;
  std::string why;
};

class Export {
 public:
  Export(const ExportArguments& arguments, recording::mcap::Reader& reader)
      : arguments_(arguments),
        reader_(reader),
        decoder_(reader),
        names_(export_names(reader.contents())) {}

  int run() {
    bool damaged = !reader_.contents().damage.empty();
    for (const Error& error : reader_.contents().damage) log::warning(error);
    for (const Error& error : reader_.measured().remarks) log::warning(error);
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
    if (auto done = close(); !done) return complain(done.error(), exit_broken);
    for (const auto& [topic, left] : left_out_)
      log::warning("{}: {} messages are left out: {}", printable(topic), left.count, left.why);
    if (tables_.empty())
      return complain({left_out_.empty() ? "holds no message of what is asked for"
                                         : "no message could be exported, for the reasons above",
                       arguments_.file, "prehend recording info FILE says what it holds"},
                      exit_no);
    return damaged || !left_out_.empty() ? exit_no : exit_done;
  }

 private:
  Expected<void> write(const recording::mcap::ReadMessage& read) {
    const auto& [channel, message] = read;
    const TableKey& table = key_of(*channel);
    const recording::types::Structure* type = decoder_.type_of(*channel);
    auto value = decoder_.decode(*channel, message.data);
    if (!type && value && arguments_.format == "csv")
      value = fail(fmt::format("encoding «{}» tells no columns; --format jsonl takes it",
                               printable(channel->message_encoding)));
    if (!value) {
      LeftOut& left = left_out_[table.first];
      if (left.count++ == 0) left.why = value.error().what;
      return {};
    }
    const auto out = stream(table, type);
    if (!out) return tl::unexpected(out.error());
    if (arguments_.format == "csv") {
      **out << message.log_time << ',' << message.publish_time << ',' << message.sequence;
      for (const std::string& cell : cells(*type, *value)) **out << ',' << cell;
      **out << '\n';
    } else {
      **out << Json{{"topic", table.first},
                    {"log_time_ns", message.log_time},
                    {"publish_time_ns", message.publish_time},
                    {"sequence", message.sequence},
                    {"message", recording::types::to_json(*value)}}
                   .dump(-1, ' ', false, Json::error_handler_t::replace)
            << '\n';
    }
    if (!**out) return not_written(table);
    return {};
  }

  const TableKey& key_of(const recording::mcap::Channel& channel) {
    const auto known = keys_.find(channel.id);
    if (known != keys_.end()) return known->second;
    return keys_.emplace(channel.id, table_of(channel, reader_.contents())).first->second;
  }

  std::filesystem::path file_of(const TableKey& table) const {
    return std::filesystem::path(arguments_.folder) / (names_.at(table) + "." + arguments_.format);
  }
  tl::unexpected<Error> not_written(const TableKey& table) const {
    return fail("cannot be written",
                arguments_.folder.empty() ? "standard output" : file_of(table).string(),
                "is there room, and is the folder writable?");
  }

  /// Where the table's rows go; a table of CSV begins with its heading. The folder is made with its
  /// first file.
  Expected<std::ostream*> stream(const TableKey& table, const recording::types::Structure* type) {
    const auto [place, fresh] = tables_.try_emplace(table);
    std::ostream* out = &std::cout;
    if (!arguments_.folder.empty()) {
      if (fresh) {
        std::error_code problem;
        std::filesystem::create_directories(arguments_.folder, problem);
        if (problem) return fail(problem.message(), arguments_.folder);
        place->second.open(file_of(table));
        if (names_.at(table).size() != file_topic_size(table))
          log::info("{} is in {}", printable(table.first), file_of(table).string());
      }
      if (!place->second) return not_written(table);
      out = &place->second;
    }
    if (fresh && arguments_.format == "csv") {
      *out << "log_time_ns,publish_time_ns,sequence";
      for (const std::string& column : columns(*type)) *out << ',' << column;
      *out << '\n';
    }
    return out;
  }
  static std::size_t file_topic_size(const TableKey& table) {
    return table.first.size() - (table.first.starts_with('/') ? 1 : 0);
  }

  /// What is still in buffers may find no room.
  Expected<void> close() {
    for (auto& [table, file] : tables_) {
      if (arguments_.folder.empty()) continue;
      file.close();
      if (!file) return not_written(table);
    }
    return {};
  }

  const ExportArguments& arguments_;
  recording::mcap::Reader& reader_;
  recording::MessageDecoder decoder_;
  std::map<TableKey, std::string> names_;
  std::map<std::uint16_t, TableKey> keys_;  // by channel
  std::map<TableKey, std::ofstream> tables_;
  std::map<std::string, LeftOut> left_out_;  // by topic
};

/// Tables of these topics that have messages.
std::set<TableKey> wanted_tables(const ExportArguments& arguments,
                                 recording::mcap::Reader& reader) {
  std::set<TableKey> tables;
  for (const auto& [id, count] : reader.statistics().channel_message_counts) {
    const auto channel = reader.contents().channels.find(id);
    if (channel == reader.contents().channels.end() || count == 0) continue;
    const auto topic = recording::recorded_topic(channel->second, reader.contents());
    if (topic.end.empty() && matches(arguments.topics, topic.name))
      tables.insert(table_of(channel->second, reader.contents()));
  }
  return tables;
}

int run_tables(const ExportArguments& arguments) {
  auto reader = recording::mcap::Reader::open(arguments.file);
  if (!reader) return complain_of(arguments.file, reader.error());
  const auto tables = wanted_tables(arguments, *reader);
  if (matching(arguments.topics, reader->contents()).empty())
    return complain(no_such_topic(arguments.topics, arguments.file), exit_no);
  if (arguments.folder.empty() && arguments.format == "csv" && tables.size() > 1)
    return complain({"a table holds one topic of one type", fmt::format("{} tables", tables.size()),
                     "choose one with --topic, or a folder for all with -o"},
                    exit_wrong_use);
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
