#include "common/recording/mcap/writer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace prehend::recording::mcap {
namespace {

// Without chunks messages are gathered up to this size before they are written.
constexpr std::size_t max_pending = 256 * 1024;

template <class Places>
Expected<std::uint16_t> free_id(const Places& places, const char* what, const File& file) {
  constexpr std::uint16_t last = std::numeric_limits<std::uint16_t>::max();
  if (!places.contains(last))
    return static_cast<std::uint16_t>(places.empty() ? 1 : places.rbegin()->first + 1);
  // Who chose the last id itself has left some out.
  for (std::uint16_t id = 1; id < last; ++id)
    if (!places.contains(id)) return id;
  return fail(std::string("more than 65535 ") + what, file.name(), "split the recording");
}

bool same(const Schema& a, const Schema& b) {
  return a.name == b.name && a.encoding == b.encoding && a.data == b.data;
}
bool same(const Channel& a, const Channel& b) {
  return a.schema_id == b.schema_id && a.topic == b.topic &&
         a.message_encoding == b.message_encoding && a.metadata == b.metadata;
}

}  // namespace

Writer::Writer(File file, WriterOptions options)
    : file_(std::move(file)), options_(std::move(options)) {
  append(pending_, View(magic));
  append_record(pending_, Header{options_.profile, options_.library}, options_.padding);
}

Expected<Writer> Writer::create(const std::filesystem::path& path, WriterOptions options) {
  Expected<File> file = File::create(path);
  if (!file) return tl::unexpected(file.error());
  Writer writer(std::move(*file), std::move(options));
  if (auto done = writer.put(); !done) return tl::unexpected(done.error());
  return writer;
}

Writer::~Writer() {
  (void)close();
}

template <class Type>
void Writer::append_data(const Type& record) {
  if (options_.chunks)
    append_record(chunk_, record);
  else
    append_record(pending_, record, Type::opcode == Message::opcode ? View{} : options_.padding);
}

Expected<std::uint16_t> Writer::add_schema(std::string name, std::string encoding,
                                           std::string data) {
  const Expected<std::uint16_t> id = free_id(schema_places_, "schemas", file_);
  if (!id) return id;
  if (auto done = write(Schema{*id, std::move(name), std::move(encoding), std::move(data)}); !done)
    return tl::unexpected(done.error());
  return id;
}

Expected<std::uint16_t> Writer::add_channel(std::uint16_t schema_id, std::string topic,
                                            std::string message_encoding, StringMap metadata) {
  const Expected<std::uint16_t> id = free_id(channel_places_, "channels", file_);
  if (!id) return id;
  if (auto done = write(Channel{*id, schema_id, std::move(topic), std::move(message_encoding),
                                std::move(metadata)});
      !done)
    return tl::unexpected(done.error());
  return id;
}

Expected<void> Writer::write(const Schema& schema) {
  if (broken_) return tl::unexpected(*broken_);
  if (schema.id == 0) return fail("schema id 0 means «none»", file_.name());
  if (const auto known = schema_places_.find(schema.id); known != schema_places_.end()) {
    if (same(schemas_[known->second], schema)) return {};
    return fail("schema " + std::to_string(schema.id) + " is something else", file_.name());
  }
  schema_places_[schema.id] = schemas_.size();
  schemas_.push_back(schema);
  ++statistics_.schema_count;
  append_data(schema);
  return {};
}

Expected<void> Writer::write(const Channel& channel) {
  if (broken_) return tl::unexpected(*broken_);
  if (channel.schema_id != 0 && !schema_places_.contains(channel.schema_id))
    return fail("topic " + channel.topic + " has a schema that was not added", file_.name());
  if (const auto known = channel_places_.find(channel.id); known != channel_places_.end()) {
    if (same(channels_[known->second], channel)) return {};
    return fail("channel " + std::to_string(channel.id) + " is something else", file_.name());
  }
  channel_places_[channel.id] = channels_.size();
  channels_.push_back(channel);
  ++statistics_.channel_count;
  append_data(channel);
  return {};
}

Expected<void> Writer::write(const Message& message) {
  if (broken_) return tl::unexpected(*broken_);
  if (!channel_places_.contains(message.channel_id))
    return fail("channel " + std::to_string(message.channel_id) + " was not added", file_.name());
  const std::uint64_t time = message.log_time;
  statistics_.count(message.channel_id, time);
  if (!options_.chunks) {
    append_data(message);
    return pending_.size() < max_pending ? Expected<void>{} : put();
  }
  if (options_.message_index) {
    if (message.channel_id >= index_places_.size())
      index_places_.resize(message.channel_id + std::size_t{1});
    std::uint32_t& place = index_places_[message.channel_id];
    if (place == 0) {
      chunk_indexes_.push_back(MessageIndex{message.channel_id, {}});
      place = static_cast<std::uint32_t>(chunk_indexes_.size());
    }
    chunk_indexes_[place - 1].records.emplace_back(time, chunk_.size());
  }
  append_data(message);
  if (chunk_times_) {
    chunk_times_->first = std::min(chunk_times_->first, time);
    chunk_times_->second = std::max(chunk_times_->second, time);
  } else {
    chunk_times_.emplace(time, time);
  }
  const auto span = chunk_times_->second - chunk_times_->first;
  if (chunk_.size() < options_.chunk_bytes &&
      span < static_cast<std::uint64_t>(options_.chunk_duration.count()))
    return {};
  return flush();
}

Expected<void> Writer::write(const Attachment& attachment) {
  if (broken_) return tl::unexpected(*broken_);
  const std::uint64_t start = position();
  append_record(pending_, attachment, options_.padding);
  ++statistics_.attachment_count;
  if (options_.attachment_index)
    append_record(
        attachment_index_records_,
        AttachmentIndex{start, position() - start, attachment.log_time, attachment.create_time,
                        attachment.data.size(), attachment.name, attachment.media_type},
        options_.padding);
  return put();
}

Expected<void> Writer::write(const Metadata& metadata) {
  if (broken_) return tl::unexpected(*broken_);
  const std::uint64_t start = position();
  append_record(pending_, metadata, options_.padding);
  ++statistics_.metadata_count;
  if (options_.metadata_index)
    append_record(metadata_index_records_, MetadataIndex{start, position() - start, metadata.name},
                  options_.padding);
  return put();
}

Expected<void> Writer::flush() {
  if (broken_) return tl::unexpected(*broken_);
  if (auto done = close_chunk(); !done) return done;
  return put();
}

Expected<void> Writer::sync() {
  if (auto done = flush(); !done) return done;
  return file_.sync();
}

Expected<void> Writer::close_chunk() {
  if (chunk_.empty()) return {};
  compressed_.clear();
  if (auto done = compress(options_.compression, chunk_, compressed_); !done) return done;
  const auto [first, last] = chunk_times_.value_or(std::pair<std::uint64_t, std::uint64_t>{0, 0});
  ChunkIndex index{.message_start_time = first,
                   .message_end_time = last,
                   .chunk_start_offset = position(),
                   .compression = std::string(name(options_.compression)),
                   .compressed_size = compressed_.size(),
                   .uncompressed_size = chunk_.size()};
  append_record(pending_, Chunk{first, last, chunk_.size(), options_.crcs ? crc32(chunk_) : 0,
                                index.compression, compressed_});
  index.chunk_length = position() - index.chunk_start_offset;
  const std::uint64_t indexes_start = position();
  for (const MessageIndex& each : chunk_indexes_) {
    index.message_index_offsets.emplace_back(each.channel_id, position());
    append_record(pending_, each, options_.padding);
  }
  index.message_index_length = position() - indexes_start;
  if (options_.chunk_index) append_record(chunk_index_records_, index, options_.padding);
  ++statistics_.chunk_count;
  chunk_.clear();
  chunk_times_.reset();
  for (const MessageIndex& each : chunk_indexes_) index_places_[each.channel_id] = 0;
  chunk_indexes_.clear();
  return {};
}

Expected<void> Writer::put() {
  if (options_.crcs) data_crc_ = crc32(pending_, data_crc_);
  auto done = file_.write(pending_);
  if (!done) broken_ = done.error();
  pending_.clear();
  return done;
}

Expected<void> Writer::close() {
  if (closed_ || file_.size() == 0) return {};
  closed_ = true;
  if (auto done = flush(); !done) return done;
  auto done = write_summary();
  broken_ = Error{"the recording is closed", file_.name(), ""};
  return done;
}

Expected<void> Writer::write_summary() {
  append_record(pending_, DataEnd{data_crc_});
  const std::size_t data_end = pending_.size();

  std::vector<SummaryOffset> groups;
  const auto group = [&](std::uint8_t opcode, const auto& append_all) {
    const std::uint64_t start = position();
    append_all();
    if (position() > start) groups.push_back({opcode, start, position() - start});
  };
  group(Schema::opcode, [&] {
    if (options_.repeated_schemas)
      for (const Schema& schema : schemas_) append_record(pending_, schema, options_.padding);
  });
  group(Channel::opcode, [&] {
    if (options_.repeated_channels)
      for (const Channel& channel : channels_) append_record(pending_, channel, options_.padding);
  });
  group(Statistics::opcode, [&] {
    if (options_.statistics) append_record(pending_, statistics_, options_.padding);
  });
  group(MetadataIndex::opcode, [&] { append(pending_, View(metadata_index_records_)); });
  group(AttachmentIndex::opcode, [&] { append(pending_, View(attachment_index_records_)); });
  group(ChunkIndex::opcode, [&] { append(pending_, View(chunk_index_records_)); });

  Footer footer;
  if (!groups.empty()) {
    footer.summary_start = file_.size() + data_end;
    if (options_.summary_offsets) {
      footer.summary_offset_start = position();
      for (const SummaryOffset& each : groups) append_record(pending_, each, options_.padding);
    }
  }
  append_record(pending_, footer);
  // The CRC covers all from behind the data end up to itself, and is the last field.
  if (options_.crcs)
    overwrite(pending_, pending_.size() - 4,
              crc32(View(pending_).subspan(data_end, pending_.size() - 4 - data_end)));
  append(pending_, View(magic));
  return put();
}

}  // namespace prehend::recording::mcap
