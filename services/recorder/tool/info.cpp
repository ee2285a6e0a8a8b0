#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <prehend/base/log.hpp>
#include <prehend/compare/recorded_topic.hpp>

#include "tool.hpp"

namespace prehend::recorder {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string file;
  bool json = false;
};

struct TopicInfo {
  std::string type;
  std::uint64_t count = 0;
  std::uint64_t ends = 0;  // disposed or unregistered
  std::size_t writers = 0;
};

std::map<std::string, TopicInfo> topics_of(const mcap::Contents& contents,
                                           const mcap::Statistics& statistics) {
  std::map<std::string, TopicInfo> topics;
  std::map<std::string, std::set<std::string, std::less<>>> writers;
  for (const auto& [id, channel] : contents.channels) {
    const recording::RecordedTopic about = recording::recorded_topic(channel, contents);
    TopicInfo& topic = topics[about.name];
    topic.type = about.type;
    writers[about.name].emplace(mcap::find(channel.metadata, "writer"));
    for (const auto& [channel_id, count] : statistics.channel_message_counts)
      if (channel_id == id) (about.end.empty() ? topic.count : topic.ends) += count;
  }
  for (auto& [name, topic] : topics) topic.writers = writers[name].size();
  return topics;
}

/// Of the records of losses the last one counts.
std::uint64_t lost(const mcap::Reader& reader) {
  const auto& metadata = reader.contents().metadata;
  const auto last = std::find_if(metadata.rbegin(), metadata.rend(),
                                 [](const auto& index) { return index.name == "losses"; });
  if (last == metadata.rend()) return 0;
  std::uint64_t sum = 0;
  if (const auto record = reader.metadata(*last)) {
    for (const auto& [topic, text] : record->metadata) {
      std::uint64_t count = 0;
      std::from_chars(text.data(), text.data() + text.size(), count);
      sum += count;
    }
  }
  return sum;
}

std::string date(std::uint64_t ns) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(ns / 1'000'000'000)));
}

Json to_json(const mcap::Reader& reader, const mcap::Statistics& statistics,
             const std::map<std::string, TopicInfo>& topics) {
  const mcap::Contents& contents = reader.contents();
  const double duration =
      static_cast<double>(statistics.message_end_time - statistics.message_start_time) * 1e-9;
  Json document{{"duration_s", duration}, {"lost", lost(reader)}, {"topics", Json::array()}};
  for (const auto& [name, topic] : topics)
    document["topics"].push_back({{"name", name},
                                  {"type", topic.type},
                                  {"count", topic.count},
                                  {"ends", topic.ends},
                                  {"writers", topic.writers}});
  document["messages"] = statistics.message_count;
  document["start_ns"] = statistics.message_start_time;
  document["end_ns"] = statistics.message_end_time;
  document["size"] = reader.file().size();
  document["chunks"] = contents.chunks.size();
  document["compression"] = contents.chunks.empty() ? "" : contents.chunks.front().compression;
  document["library"] = contents.header.library;
  document["closed"] = contents.closed;
  document["attachments"] = Json::array();
  for (const auto& each : contents.attachments) document["attachments"].push_back(each.name);
  document["metadata"] = Json::array();
  for (const auto& each : contents.metadata) document["metadata"].push_back(each.name);
  document["damage"] = Json::array();
  for (const Error& error : contents.damage) document["damage"].push_back(error.message());
  return document;
}

void print(const Json& document, const mcap::Statistics& statistics) {
  fmt::print("{} messages in {:.3f} s, {} lost; {:.1f} MB in {} chunks{}\n",
             statistics.message_count, document["duration_s"].get<double>(),
             document["lost"].get<std::uint64_t>(),
             static_cast<double>(document["size"].get<std::uint64_t>()) * 1e-6,
             document["chunks"].get<std::size_t>(),
             document["compression"] == "" ? std::string()
                                           : ", " + document["compression"].get<std::string>());
  if (statistics.message_count > 0)
    fmt::print("from {} to {}\n", date(statistics.message_start_time),
               date(statistics.message_end_time));
  for (const Json& topic : document["topics"])
    fmt::print("  {:24} {:10} {}\n", topic["name"].get<std::string>(),
               topic["count"].get<std::uint64_t>(), topic["type"].get<std::string>());
}

int info(const Arguments& arguments) {
  auto reader = mcap::Reader::open(arguments.file);
  if (!reader) return complain_of(arguments.file, reader.error());
  const auto statistics = reader->statistics();
  if (!statistics) return complain(statistics.error(), exit_no);
  const Json document = to_json(*reader, *statistics, topics_of(reader->contents(), *statistics));
  if (arguments.json)
    std::cout << document.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print(document, *statistics);
  for (const Error& error : reader->contents().damage) log::warning("{}", error.message());
  return exit_done;
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("info", "what is in a recording");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->file, "recording")->required();
  command->add_flag("--json", arguments->json, "one JSON document");
  command->callback([arguments, &exit_code] { exit_code = info(*arguments); });
}

}  // namespace prehend::recorder
