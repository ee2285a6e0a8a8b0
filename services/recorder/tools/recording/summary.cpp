#include "services/recorder/tools/recording/summary.hpp"

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/recording/compare/recorded_topic.hpp"

namespace prehend::recorder {
namespace {

using Json = nlohmann::ordered_json;

struct TopicInfo {
  std::string type;
  std::uint64_t count = 0;
  std::uint64_t ends = 0;  // disposed or unregistered
  std::size_t writers = 0;
};

std::map<std::string, TopicInfo> topics_of(const recording::mcap::Contents& contents,
                                           const recording::mcap::Statistics& statistics) {
  std::map<std::string, TopicInfo> topics;
  std::map<std::string, std::set<std::string, std::less<>>> writers;
  for (const auto& [id, channel] : contents.channels) {
    const recording::RecordedTopic about = recording::recorded_topic(channel, contents);
    TopicInfo& topic = topics[about.name];
    topic.type = about.type;
    writers[about.name].emplace(recording::mcap::find(channel.metadata, "writer"));
    for (const auto& [channel_id, count] : statistics.channel_message_counts)
      if (channel_id == id) (about.end.empty() ? topic.count : topic.ends) += count;
  }
  for (auto& [name, topic] : topics) topic.writers = writers[name].size();
  return topics;
}

/// Of the records of losses the last one counts.
std::uint64_t lost(const recording::mcap::Reader& reader) {
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

}  // namespace

Json summary(recording::mcap::Reader& reader) {
  const recording::mcap::Measured& measured = reader.measured();
  const recording::mcap::Statistics& statistics = measured.statistics;
  const recording::mcap::Contents& contents = reader.contents();
  const double duration =
      static_cast<double>(statistics.message_end_time - statistics.message_start_time) * 1e-9;
  Json document{{"duration_s", duration}, {"lost", lost(reader)}, {"topics", Json::array()}};
  for (const auto& [name, topic] : topics_of(contents, statistics))
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
  const auto messages = [](std::initializer_list<const std::vector<Error>*> lists) {
    Json all = Json::array();
    for (const auto* list : lists)
      for (const Error& error : *list) all.push_back(error.message());
    return all;
  };
  document["damage"] = messages({&contents.damage, &measured.damage});
  document["remarks"] = messages({&contents.remarks, &measured.remarks});
  return document;
}

}  // namespace prehend::recorder
