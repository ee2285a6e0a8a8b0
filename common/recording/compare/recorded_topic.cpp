#include "recorded_topic.hpp"

#include <prehend/types/idl.hpp>
#include <prehend/types/schema_text.hpp>

namespace prehend::recording {

RecordedTopic recorded_topic(const mcap::Channel& channel, const mcap::Contents& contents) {
  RecordedTopic topic{channel.topic, std::string(mcap::find(channel.metadata, "type")), {}};
  const std::string_view change = mcap::find(channel.metadata, "change");
  if (!change.empty()) {
    topic.name = mcap::find(channel.metadata, "of");
    topic.end = change;
    topic.end += " ";
    topic.end += mcap::find(channel.metadata, "instance");
  }
  const auto schema = contents.schemas.find(channel.schema_id);
  if (topic.type.empty() && schema != contents.schemas.end()) topic.type = schema->second.name;
  return topic;
}

RecordedTypes::RecordedTypes(const mcap::Reader& reader) : reader_(reader) {
  for (const mcap::MetadataIndex& index : reader.contents().metadata) {
    if (index.name != "idl") continue;
    if (const auto record = reader.metadata(index))
      for (const auto& [type, text] : record->metadata) idl_[type] = text;
  }
}

const types::Structure* RecordedTypes::of(const mcap::Channel& channel) {
  const auto known = known_.find(channel.id);
  if (known != known_.end()) return known->second;
  return known_[channel.id] = find(channel);
}

const types::Structure* RecordedTypes::find(const mcap::Channel& channel) {
  const RecordedTopic topic = recorded_topic(channel, reader_.contents());
  if (!topic.end.empty() || channel.message_encoding != "cdr") return nullptr;
  if (const auto idl = idl_.find(topic.type); idl != idl_.end()) {
    types::Library& library = libraries_["idl " + topic.type];
    if (library.structures().empty()) (void)types::parse_idl(idl->second, topic.type, library);
    if (const types::Structure* type = library.find(topic.type)) return type;
  }
  const auto found = reader_.contents().schemas.find(channel.schema_id);
  if (found == reader_.contents().schemas.end()) return nullptr;
  const mcap::Schema& schema = found->second;
  types::Library& library = libraries_[schema.encoding + " " + std::to_string(schema.id)];
  if (schema.encoding == "ros2msg") {
    const auto type = types::parse_ros2msg(schema.name, schema.data, library);
    return type ? *type : nullptr;
  }
  if (schema.encoding == "omgidl") {
    if (library.structures().empty()) (void)types::parse_idl(schema.data, schema.name, library);
    return library.find(schema.name);
  }
  return nullptr;
}

}  // namespace prehend::recording
