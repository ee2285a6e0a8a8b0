#include "services/recorder/tools/recording/export_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "common/recording/compare/recorded_topic.hpp"

namespace prehend::recorder {
namespace {

constexpr std::size_t max_name = 150;  // bytes; file systems take 255, with the ending

/// glove/frame is glove-frame. Letters beyond ASCII stay.
std::string plain_name(std::string topic) {
  topic.erase(0, std::min(topic.find_first_not_of('/'), topic.size()));
  for (char& c : topic) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && std::isalnum(byte) == 0 && c != '_' && c != '.') c = '-';
  }
  if (topic.empty() || topic.front() == '.') topic.insert(0, "-");
  return topic;
}

/// Some file systems take capitals for small letters.
std::string folded(std::string name) {
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

std::string with_sum(const std::string& name, const TableKey& key) {
  const std::string text = key.first + '\n' + key.second;
  std::size_t end = std::min(name.size(), max_name);
  while (end > 0 && end < name.size() && (name[end] & 0xc0) == 0x80) --end;  // a whole character
  return fmt::format("{}-{:08x}", name.substr(0, end),
                     recording::mcap::crc32(recording::mcap::view(text)));
}

}  // namespace

TableKey table_of(const recording::mcap::Channel& channel,
                  const recording::mcap::Contents& contents) {
  const auto topic = recording::recorded_topic(channel, contents);
  const auto schema = contents.schemas.find(channel.schema_id);
  const std::string text = schema == contents.schemas.end() ? "" : schema->second.data;
  return {topic.name, fmt::format("{} {} {:08x}", topic.type, channel.message_encoding,
                                  recording::mcap::crc32(recording::mcap::view(text)))};
}

std::map<TableKey, std::string> export_names(const recording::mcap::Contents& contents) {
  std::set<TableKey> tables;
  for (const auto& [id, channel] : contents.channels)
    if (recording::recorded_topic(channel, contents).end.empty())
      tables.insert(table_of(channel, contents));
  std::map<std::string, int> wanted;  // how many tables want a name
  for (const auto& [topic, type] : tables) ++wanted[folded(plain_name(topic))];
  std::map<TableKey, std::string> names;
  for (const TableKey& key : tables) {
    const std::string name = plain_name(key.first);
    const bool own = wanted[folded(name)] == 1 && name.size() <= max_name;
    names.emplace(key, own ? name : with_sum(name, key));
  }
  return names;
}

}  // namespace prehend::recorder
