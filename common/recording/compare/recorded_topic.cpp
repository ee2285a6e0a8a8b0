#include "common/recording/compare/recorded_topic.hpp"

#include "common/recording/types/idl.hpp"
#include "common/recording/types/ros2idl.hpp"
#include "common/recording/types/schema_text.hpp"

namespace prehend::recording {

RecordedTopic recorded_topic(const recording::mcap::Channel& channel,
                             const recording::mcap::Contents& contents) {
  RecordedTopic topic{
      channel.topic, std::string(recording::mcap::find(channel.metadata, "type")), {}};
  const std::string_view change = recording::mcap::find(channel.metadata, "change");
  if (!change.empty()) {
    topic.name = recording::mcap::find(channel.metadata, "of");
    topic.end = change;
    topic.end += " ";
    topic.end += recording::mcap::find(channel.metadata, "instance");
  }
  const auto schema = contents.schemas.find(channel.schema_id);
  if (topic.type.empty() && schema != contents.schemas.end()) topic.type = schema->second.name;
  return topic;
}

RecordedTypes::RecordedTypes(const recording::mcap::Reader& reader) : reader_(reader) {
  for (const recording::mcap::MetadataIndex& index : reader.contents().metadata) {
    if (index.name != "idl") continue;
    if (const auto record = reader.metadata(index))
      for (const auto& [type, text] : record->metadata) idl_[type] = text;
  }
}

const recording::types::Structure* RecordedTypes::of(const recording::mcap::Channel& channel) {
  return channel.message_encoding == "cdr" ? known(channel) : nullptr;
}

const recording::types::Structure* RecordedTypes::of_ros1(const recording::mcap::Channel& channel) {
  return channel.message_encoding == "ros1" ? known(channel) : nullptr;
}

const recording::types::Structure* RecordedTypes::known(const recording::mcap::Channel& channel) {
  const auto known = known_.find(channel.id);
  if (known != known_.end()) return known->second;
  return known_[channel.id] = find(channel);
}

const recording::types::Structure* RecordedTypes::find(const recording::mcap::Channel& channel) {
  const RecordedTopic topic = recorded_topic(channel, reader_.contents());
  if (!topic.end.empty()) return nullptr;
  const bool ros1 = channel.message_encoding == "ros1";
  if (const auto idl = idl_.find(topic.type); idl != idl_.end()) {
    recording::types::Library& library = libraries_["idl " + topic.type];
    if (library.structures().empty())
      (void)recording::types::parse_idl(idl->second, topic.type, library);
    if (const recording::types::Structure* type = library.find(topic.type)) return type;
  }
  const auto found = reader_.contents().schemas.find(channel.schema_id);
  if (found == reader_.contents().schemas.end()) return nullptr;
  const recording::mcap::Schema& schema = found->second;
  recording::types::Library& library =
      libraries_[schema.encoding + " " + std::to_string(schema.id)];
  if (ros1 ? schema.encoding == "ros1msg" : schema.encoding == "ros2msg") {
    const auto type = recording::types::parse_ros2msg(schema.name, schema.data, library);
    return type ? *type : nullptr;
  }
  if (ros1) return nullptr;
  if (schema.encoding == "ros2idl") {
    const auto type = recording::types::parse_ros2idl(schema.name, schema.data, library);
    return type ? *type : nullptr;
  }
  if (schema.encoding == "omgidl") {
    if (library.structures().empty())
      (void)recording::types::parse_idl(schema.data, schema.name, library);
    return library.find(schema.name);
  }
  return nullptr;
}

}  // namespace prehend::recording
