#include "services/recorder/tools/recording/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/record_stream.hpp"

namespace prehend::recorder {
namespace {

using namespace recording::mcap;

// A file that is wrong throughout is told of in this many lines.
constexpr std::size_t max_findings = 100;

bool same(const Schema& a, const Schema& b) {
  return a.name == b.name && a.encoding == b.encoding && a.data == b.data;
}
bool same(const Channel& a, const Channel& b) {
  return a.schema_id == b.schema_id && a.topic == b.topic &&
         a.message_encoding == b.message_encoding && a.metadata == b.metadata;
}

class Verification {
 public:
  explicit Verification(const File& file) : file_(file) {}

  std::vector<Error> run() {
    data_section();
    if (data_ended_) summary();
    return std::move(findings_);
  }

 private:
  void find(std::uint64_t offset, std::string what) {
    if (findings_.size() < max_findings)
      findings_.push_back({std::move(what), file_.at(offset), ""});
    else if (findings_.size() == max_findings)
      findings_.push_back({"and more", file_.name(), ""});
  }

  void data_section() {
    // The CRC covers all from the first byte on, also what does not parse.
    if (const auto start = file_.read(0, magic.size())) crc_ = crc32(*start);
    RecordStream records(file_, magic.size(), file_.size());
    while (!data_ended_) {
      const auto raw = records.next();
      if (!raw || !*raw) {
        if (!raw) findings_.push_back(raw.error());
        find(records.position(), "the data section has no end");
        return;
      }
      const auto record = parse((*raw)->opcode, (*raw)->content);
      if (!record)
        find((*raw)->offset, record.error().what);
      else
        std::visit([&](const auto& each) { take(each, **raw); }, *record);
      if (data_ended_) break;
      // The head was read with the content; it is read again only for the CRC.
      if (const auto head = file_.read((*raw)->offset, record_head)) crc_ = crc32(*head, crc_);
      crc_ = crc32((*raw)->content, crc_);
    }
    summary_begin_ = records.position();
  }

  void take(const Header&, const RawRecord& raw) {
    if (raw.offset != magic.size()) find(raw.offset, "a header that is not the first record");
  }
  void take(const Schema& schema, const RawRecord& raw) {
    if (schema.id == 0) return find(raw.offset, "a schema with id 0");
    const auto [known, fresh] = schemas_.emplace(schema.id, schema);
    if (!fresh && !same(known->second, schema))
      find(raw.offset, fmt::format("schema {} was something else before", schema.id));
  }
  void take(const Channel& channel, const RawRecord& raw) {
    if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id))
      find(raw.offset, fmt::format("channel {} has schema {}, which is not in front of it",
                                   channel.id, channel.schema_id));
    const auto [known, fresh] = channels_.emplace(channel.id, channel);
    if (!fresh && !same(known->second, channel))
      find(raw.offset, fmt::format("channel {} was something else before", channel.id));
  }
  void take(const Message& message, const RawRecord& raw) {
    if (!channels_.contains(message.channel_id))
      find(raw.offset,
           fmt::format("a message of channel {}, which is not in front of it", message.channel_id));
    counted_.count(message.channel_id, message.log_time);
  }
  void take(const Attachment& attachment, const RawRecord& raw) {
    const auto covered = static_cast<std::size_t>(attachment.data.data() + attachment.data.size() -
                                                  raw.content.data());
    if (attachment.crc != 0 && crc32(raw.content.first(covered)) != attachment.crc)
      find(raw.offset, "an attachment's CRC is wrong");
    ++counted_.attachment_count;
    attachments_[raw.offset] = {raw.offset,
                                raw.end() - raw.offset,
                                attachment.log_time,
                                attachment.create_time,
                                attachment.data.size(),
                                attachment.name,
                                attachment.media_type};
  }
  void take(const Metadata& metadata, const RawRecord& raw) {
    ++counted_.metadata_count;
    metadata_[raw.offset] = {raw.offset, raw.end() - raw.offset, metadata.name};
  }
  void take(const DataEnd& end, const RawRecord& raw) {
    data_ended_ = true;
    if (end.data_section_crc != 0 && end.data_section_crc != crc_)
      find(raw.offset, "the CRC of the data section is wrong");
  }
  void take(const Unknown&, const RawRecord&) {}
  template <class Type>
  void take(const Type&, const RawRecord& raw) {
    find(raw.offset, "a record of the summary lies in the data section");
  }

  void take(const Chunk& chunk, const RawRecord& raw) {
    ++counted_.chunk_count;
    last_chunk_ = raw.offset;
    chunks_[raw.offset] = {.message_start_time = chunk.message_start_time,
                           .message_end_time = chunk.message_end_time,
                           .chunk_start_offset = raw.offset,
                           .chunk_length = raw.end() - raw.offset,
                           .compression = chunk.compression,
                           .compressed_size = chunk.records.size(),
                           .uncompressed_size = chunk.uncompressed_size};
    in_chunk_.clear();
    const auto expanded = expand(chunk);
    if (!expanded) return find(raw.offset, expanded.error().what);
    Statistics inside;
    ChunkRecords records(*expanded);
    while (true) {
      const auto each = records.next();
      if (!each) return find(raw.offset, each.error().message());
      if (!*each) break;
      const auto record = parse((*each)->opcode, (*each)->content);
      // Whatever is found inside is said to be in the chunk.
      const RawRecord placed{(*each)->opcode, raw.offset, (*each)->content};
      if (!record) {
        find(raw.offset, record.error().what);
      } else if (const auto* schema = std::get_if<Schema>(&*record)) {
        take(*schema, placed);
      } else if (const auto* channel = std::get_if<Channel>(&*record)) {
        take(*channel, placed);
      } else if (const auto* message = std::get_if<Message>(&*record)) {
        take(*message, placed);
        inside.count(message->channel_id, message->log_time);
        in_chunk_[message->channel_id].emplace(message->log_time, (*each)->offset);
      } else if (!std::holds_alternative<Unknown>(*record)) {
        find(raw.offset, fmt::format("a record of kind {} in a chunk", (*each)->opcode));
      }
    }
    if (inside.message_start_time != chunk.message_start_time ||
        inside.message_end_time != chunk.message_end_time)
      find(raw.offset, "a chunk's times are not those of its messages");
  }

  void take(const MessageIndex& index, const RawRecord& raw) {
    if (!last_chunk_) return find(raw.offset, "a message index without a chunk");
    ChunkIndex& chunk = chunks_[*last_chunk_];
    chunk.message_index_offsets.emplace_back(index.channel_id, raw.offset);
    chunk.message_index_length += raw.end() - raw.offset;
    const std::set<std::pair<std::uint64_t, std::uint64_t>> said(index.records.begin(),
                                                                 index.records.end());
    if (said != in_chunk_[index.channel_id])
      find(raw.offset, fmt::format("the message index of channel {} is not what its chunk holds",
                                   index.channel_id));
  }

  void summary() {
    constexpr std::uint64_t tail = record_head + footer_content + magic.size();
    if (file_.size() < summary_begin_ + tail) return find(summary_begin_, "the file has no footer");
    const std::uint64_t footer_at = file_.size() - tail;
    const auto end = file_.read(footer_at, tail);
    const auto footer =
        parse_as<Footer>((*end)[0], View(*end).subspan(record_head, footer_content));
    if (!footer || !std::equal(magic.begin(), magic.end(), end->end() - magic.size()))
      return find(footer_at, "the file has no footer");
    const bool has_summary = footer->summary_start != 0;
    if (has_summary && footer->summary_start != summary_begin_)
      find(footer_at, "the footer says that the summary is elsewhere");
    const std::uint64_t covered = footer_at + record_head + 16 - summary_begin_;
    const auto bytes = file_.read(summary_begin_, covered);
    if (footer->summary_crc != 0 && crc32(*bytes) != footer->summary_crc)
      find(summary_begin_, "the summary's CRC is wrong");
    RecordStream records(file_, summary_begin_, footer_at);
    while (true) {
      const auto raw = records.next();
      if (!raw) findings_.push_back(raw.error());
      if (!raw || !*raw) break;
      const auto record = parse((*raw)->opcode, (*raw)->content);
      if (!record)
        find((*raw)->offset, record.error().what);
      else
        std::visit([&](const auto& each) { check(each, (*raw)->offset); }, *record);
      if ((*raw)->opcode == SummaryOffset::opcode) continue;
      auto& group = groups_[(*raw)->opcode];
      if (group.second != 0 && group.first + group.second != (*raw)->offset)
        find((*raw)->offset, "the summary is not grouped by kind");
      if (group.second == 0) group.first = (*raw)->offset;
      group.second += (*raw)->end() - (*raw)->offset;
    }
    for (const auto& [offset, each] : offsets_)
      if (groups_[each.group_opcode] != std::pair(each.group_start, each.group_length))
        find(offset, fmt::format("the offset of group {} is wrong", each.group_opcode));
  }

  void check(const Schema& schema, std::uint64_t offset) {
    const auto known = schemas_.find(schema.id);
    if (known == schemas_.end() || !same(known->second, schema))
      find(offset, fmt::format("schema {} of the summary is not that of the data", schema.id));
  }
  void check(const Channel& channel, std::uint64_t offset) {
    const auto known = channels_.find(channel.id);
    if (known == channels_.end() || !same(known->second, channel))
      find(offset, fmt::format("channel {} of the summary is not that of the data", channel.id));
  }
  void check(const ChunkIndex& index, std::uint64_t offset) {
    const auto found = chunks_.find(index.chunk_start_offset);
    if (found == chunks_.end()) return find(offset, "a chunk index points to no chunk");
    const ChunkIndex& chunk = found->second;
    auto said = index.message_index_offsets, there = chunk.message_index_offsets;
    std::ranges::sort(said);
    std::ranges::sort(there);
    if (index.chunk_length != chunk.chunk_length || said != there ||
        index.message_index_length != chunk.message_index_length ||
        index.message_start_time != chunk.message_start_time ||
        index.message_end_time != chunk.message_end_time ||
        index.compression != chunk.compression || index.compressed_size != chunk.compressed_size ||
        index.uncompressed_size != chunk.uncompressed_size)
      find(offset, "a chunk index is not what its chunk is");
  }
  void check(const AttachmentIndex& index, std::uint64_t offset) {
    const auto found = attachments_.find(index.offset);
    if (found == attachments_.end() || found->second.length != index.length ||
        found->second.name != index.name || found->second.media_type != index.media_type ||
        found->second.log_time != index.log_time ||
        found->second.create_time != index.create_time ||
        found->second.data_size != index.data_size)
      find(offset, "an attachment index is not what its attachment is");
  }
  void check(const MetadataIndex& index, std::uint64_t offset) {
    const auto found = metadata_.find(index.offset);
    if (found == metadata_.end() || found->second.length != index.length ||
        found->second.name != index.name)
      find(offset, "a metadata index is not what its record is");
  }
  void check(const Statistics& said, std::uint64_t offset) {
    auto counts = said.channel_message_counts, there = counted_.channel_message_counts;
    std::ranges::sort(counts);
    std::ranges::sort(there);
    std::erase_if(counts, [](const auto& each) { return each.second == 0; });
    if (said.message_count != counted_.message_count || said.schema_count != schemas_.size() ||
        said.channel_count != channels_.size() ||
        said.attachment_count != counted_.attachment_count ||
        said.metadata_count != counted_.metadata_count ||
        said.chunk_count != counted_.chunk_count ||
        said.message_start_time != counted_.message_start_time ||
        said.message_end_time != counted_.message_end_time || (!counts.empty() && counts != there))
      find(offset, "the statistics are not what is in the file");
  }
  void check(const SummaryOffset& each, std::uint64_t offset) {
    offsets_.emplace_back(offset, each);
  }
  void check(const Unknown&, std::uint64_t) {}
  template <class Type>
  void check(const Type&, std::uint64_t offset) {
    find(offset, "a record of the data section lies in the summary");
  }

  const File& file_;
  std::vector<Error> findings_;
  std::uint32_t crc_ = 0;
  bool data_ended_ = false;
  std::uint64_t summary_begin_ = 0;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint64_t, ChunkIndex> chunks_;
  std::map<std::uint64_t, AttachmentIndex> attachments_;
  std::map<std::uint64_t, MetadataIndex> metadata_;
  std::optional<std::uint64_t> last_chunk_;
  // Log times and offsets of the last chunk's messages.
  std::map<std::uint16_t, std::set<std::pair<std::uint64_t, std::uint64_t>>> in_chunk_;
  Statistics counted_;
  std::map<std::uint8_t, std::pair<std::uint64_t, std::uint64_t>> groups_;  // begin, length
  std::vector<std::pair<std::uint64_t, SummaryOffset>> offsets_;
};

}  // namespace

Expected<std::vector<Error>> verify(const std::filesystem::path& path) {
  // Whether it is one at all, the reader says.
  if (const auto reader = Reader::open(path); !reader) return tl::unexpected(reader.error());
  const auto file = File::open(path);
  if (!file) return tl::unexpected(file.error());
  return Verification(*file).run();
}

}  // namespace prehend::recorder
