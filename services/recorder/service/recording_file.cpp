#include "services/recorder/service/recording_file.hpp"

#include <cstring>

#include "common/recording/layout/layout.hpp"

namespace prehend::recorder {

std::size_t RecordingFile::Hash::operator()(const Key& key) const {
  std::uint64_t parts[4];
  std::memcpy(parts, key.writer.data(), 16);
  std::memcpy(parts + 2, key.instance.data(), 16);
  std::uint64_t hash = reinterpret_cast<std::uintptr_t>(key.source) + static_cast<int>(key.kind);
  for (const std::uint64_t part : parts) hash = (hash ^ part) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 32);
}

Expected<RecordingFile> RecordingFile::create(const std::filesystem::path& path,
                                              const Heading& heading,
                                              recording::mcap::Compression compression) {
  auto writer =
      recording::mcap::Writer::create(path, {.profile = "prehend", .compression = compression});
  if (!writer) return tl::unexpected(writer.error());
  RecordingFile file(std::move(*writer), heading);
  const auto write = [&]() -> Expected<void> {
    if (!heading.configuration.empty()) {
      const recording::mcap::StringMap pairs(heading.configuration.begin(),
                                             heading.configuration.end());
      const auto done = file.writer_.write(
          recording::mcap::Metadata{std::string(recording::configuration_record), pairs});
      if (!done) return done;
    }
    for (const auto& [name, text] :
         {std::pair(recording::scene_attachment, std::string_view(heading.scene)),
          std::pair(recording::catalogue_attachment, std::string_view(heading.catalogue))}) {
      if (text.empty()) continue;
      const auto done =
          file.writer_.write(recording::mcap::Attachment{.name = std::string(name),
                                                         .media_type = "application/toml",
                                                         .data = recording::mcap::view(text)});
      if (!done) return done;
    }
    return {};
  };
  if (const auto done = write(); !done) return tl::unexpected(done.error());
  return file;
}

Expected<std::uint16_t> RecordingFile::schema(const std::string& type) {
  if (const auto known = schemas_.find(type); known != schemas_.end()) return known->second;
  std::uint16_t id = 0;
  if (const auto description = heading_->describe ? heading_->describe(type) : std::nullopt) {
    const recording::mcap::Schema& schema = description->schema;
    const auto added = writer_.add_schema(schema.name, schema.encoding, schema.data);
    if (!added) return added;
    id = *added;
    const auto done = writer_.write(
        recording::mcap::Metadata{std::string(recording::idl_record), {{type, description->idl}}});
    if (!done) return tl::unexpected(done.error());
  }
  schemas_.emplace(type, id);
  return id;
}

Expected<std::uint16_t> RecordingFile::channel(const Key& key) {
  if (const auto known = channels_.find(key); known != channels_.end()) return known->second;
  recording::mcap::Channel channel = recording::to_channel(
      {key.source->topic, key.writer, key.instance, key.source->rig, key.kind});
  if (key.kind == dds::RawSample::Kind::data) {
    const auto id = schema(key.source->topic.type);
    if (!id) return id;
    channel.schema_id = *id;
  }
  const auto added = writer_.add_channel(channel.schema_id, channel.topic, channel.message_encoding,
                                         channel.metadata);
  if (added) channels_.emplace(key, *added);
  return added;
}

Expected<void> RecordingFile::write(const Source& source, const dds::RawSample& sample,
                                    Time log_time) {
  const auto id = channel({&source, sample.kind, sample.writer, sample.instance});
  if (!id) return tl::unexpected(id.error());
  return writer_.write(
      recording::mcap::Message{.channel_id = *id,
                               .sequence = static_cast<std::uint32_t>(sample.sequence),
                               .log_time = static_cast<std::uint64_t>(to_ns(log_time)),
                               .publish_time = static_cast<std::uint64_t>(to_ns(sample.sent)),
                               .data = sample.payload});
}

Expected<void> RecordingFile::write_losses(const std::map<std::string, std::uint64_t>& losses) {
  recording::mcap::Metadata record{std::string(recording::losses_record), {}};
  for (const auto& [topic, count] : losses)
    record.metadata.emplace_back(topic, std::to_string(count));
  return writer_.write(record);
}

}  // namespace prehend::recorder
