#include "common/recording/mcap/survey.hpp"

#include <algorithm>

#include "common/recording/mcap/compression.hpp"
#include "common/recording/mcap/record_stream.hpp"

namespace prehend::recording::mcap {
namespace {

// Loose messages are read in pieces of about this size.
constexpr std::uint64_t max_stretch = 1024 * 1024;

/// The ends of the data section, and what the footer says.
struct DataSection {
  std::uint64_t data_begin = 0;
  std::uint64_t data_end = 0;
  std::optional<Footer> footer;
  std::uint64_t footer_offset = 0;
};

bool is_magic(View bytes) {
  return std::ranges::equal(bytes, magic);
}

Expected<Header> read_header(const File& file, DataSection& frame) {
  const auto start = file.read(0, magic.size());
  if (!start) return fail("too short to be an MCAP file", file.name());
  if (!is_magic(*start)) {
    const bool other_version = std::equal(magic.begin(), magic.begin() + 5, start->begin());
    return fail(other_version ? "an MCAP file of another major version" : "not an MCAP file",
                file.name(), other_version ? "a newer prehend may read it" : "");
  }
  RecordStream records(file, magic.size(), file.size());
  const auto first = records.next();
  if (!first) return tl::unexpected(first.error());
  if (!*first) return fail("nothing behind its first bytes", file.name());
  auto header = parse_as<Header>((*first)->opcode, (*first)->content);
  if (!header) return at(file, magic.size(), header.error());
  frame.data_begin = records.position();
  return header;
}

void find_footer(const File& file, DataSection& frame) {
  frame.data_end = file.size();
  constexpr std::uint64_t tail = record_head + footer_content + magic.size();
  if (file.size() < frame.data_begin + tail) return;
  frame.footer_offset = file.size() - tail;
  const auto end = file.read(frame.footer_offset, tail);
  if (!end || !is_magic(View(*end).last(magic.size()))) return;
  Cursor cursor(*end);
  const auto opcode = cursor.number<std::uint8_t>();
  if (cursor.number<std::uint64_t>() != footer_content) return;
  const auto footer = parse_as<Footer>(opcode, cursor.take(footer_content));
  if (!footer) return;
  frame.footer = *footer;
  frame.data_end = frame.footer_offset;
  for (const std::uint64_t start : {footer->summary_offset_start, footer->summary_start})
    if (start >= frame.data_begin && start < frame.data_end) frame.data_end = start;
}

class Survey {
 public:
  Survey(const File& file, const DataSection& frame, Contents& contents)
      : file_(file), frame_(frame), contents_(contents) {}

  /// Takes the summary over, or says why not.
  Expected<void> take_summary();
  /// Walks through what the indexes do not cover.
  void walk_gaps();
  /// The footer was met, though not where the file ends.
  bool ended() const { return ended_; }

 private:
  struct Region {
    std::uint64_t begin, end;
  };
  Expected<void> check_regions();
  bool is_record(std::uint64_t offset, std::uint8_t opcode, std::uint64_t length) const;
  void walk(std::uint64_t begin, std::uint64_t end);
  void note(const RawRecord& record);
  Expected<void> take(const RawRecord& record);
  Expected<void> take_chunk(const RawRecord& record);
  Expected<void> take_inside(View records);
  std::uint64_t salvage(std::uint64_t offset, std::uint64_t end);
  bool holds_data(std::uint64_t offset) const;
  void note_what_follows(std::uint64_t position);
  void take_message(const RawRecord& record, const Message& message);

  const File& file_;
  const DataSection& frame_;
  Contents& contents_;
  std::vector<Region> regions_;  // that the indexes cover, in order
  bool after_chunk_ = false;     // message indexes that come now belong to the last chunk
  bool in_stretch_ = false;
  bool zeros_ = false, ended_ = false;
};

Expected<void> Survey::take_summary() {
  const Footer& footer = *frame_.footer;
  if (footer.summary_start == 0) return {};
  if (footer.summary_start < frame_.data_begin || footer.summary_start > frame_.footer_offset)
    return fail("damaged: the footer points outside the file", file_.at(frame_.footer_offset),
                damage_hint);
  const std::uint64_t covered = frame_.footer_offset + record_head + 16;  // by the CRC
  const auto bytes = file_.read(footer.summary_start, covered - footer.summary_start);
  if (!bytes) return tl::unexpected(bytes.error());
  if (footer.summary_crc != 0 && crc32(*bytes) != footer.summary_crc)
    return fail("damaged: the summary's CRC is wrong", file_.at(footer.summary_start), damage_hint);
  ChunkRecords records(View(*bytes).first(frame_.footer_offset - footer.summary_start));
  while (true) {
    const auto raw = records.next();
    if (!raw) return at(file_, footer.summary_start, raw.error());
    if (!*raw) break;
    const auto record = parse((*raw)->opcode, (*raw)->content);
    if (!record) return at(file_, footer.summary_start + (*raw)->offset, record.error());
    if (const auto* schema = std::get_if<Schema>(&*record))
      contents_.schemas.emplace(schema->id, *schema);
    else if (const auto* channel = std::get_if<Channel>(&*record))
      contents_.channels.emplace(channel->id, *channel);
    else if (const auto* chunk = std::get_if<ChunkIndex>(&*record))
      contents_.chunks.push_back(*chunk);
    else if (const auto* attachment = std::get_if<AttachmentIndex>(&*record))
      contents_.attachments.push_back(*attachment);
    else if (const auto* metadata = std::get_if<MetadataIndex>(&*record))
      contents_.metadata.push_back(*metadata);
    else if (const auto* statistics = std::get_if<Statistics>(&*record))
      contents_.statistics = *statistics;
  }
  // Without channels or their schemas in the summary the messages of its chunks have no names or
  // types: they are walked.
  const bool described = std::ranges::all_of(contents_.channels, [&](const auto& entry) {
    return entry.second.schema_id == 0 || contents_.schemas.contains(entry.second.schema_id);
  });
  if (contents_.channels.empty() || !described) contents_.chunks.clear();
  if (contents_.statistics && contents_.statistics->message_count > 0 &&
      contents_.statistics->channel_message_counts.empty())
    contents_.statistics.reset();
  std::ranges::sort(contents_.chunks, {}, &ChunkIndex::chunk_start_offset);
  return check_regions();
}

Expected<void> Survey::check_regions() {
  // An entry that points to something else is dropped: what it meant is then found by walking.
  const auto drop_wrong = [&](auto& entries, std::uint8_t opcode, const auto& place) {
    std::erase_if(entries, [&](const auto& entry) {
      const auto [offset, length] = place(entry);
      const bool wrong = !is_record(offset, opcode, length);
      if (wrong)
        contents_.damage.push_back(Error{"damaged: an index points here, where its record is not",
                                         file_.at(offset), damage_hint});
      return wrong;
    });
  };
  for (const ChunkIndex& chunk : contents_.chunks)
    file_.expect(chunk.chunk_start_offset, record_head);
  const auto of_chunk = [](const ChunkIndex& chunk) {
    return std::pair(chunk.chunk_start_offset, chunk.chunk_length);
  };
  const auto of_other = [](const auto& entry) { return std::pair(entry.offset, entry.length); };
  drop_wrong(contents_.chunks, Chunk::opcode, of_chunk);
  drop_wrong(contents_.attachments, Attachment::opcode, of_other);
  drop_wrong(contents_.metadata, Metadata::opcode, of_other);

  bool sound = true;
  const auto cover = [&](std::uint64_t begin, std::uint64_t length, std::uint64_t behind) {
    sound = sound && behind <= frame_.data_end - begin - length;
    regions_.push_back({begin, begin + length + behind});
  };
  for (const ChunkIndex& chunk : contents_.chunks)
    cover(chunk.chunk_start_offset, chunk.chunk_length, chunk.message_index_length);
  for (const AttachmentIndex& each : contents_.attachments) cover(each.offset, each.length, 0);
  for (const MetadataIndex& each : contents_.metadata) cover(each.offset, each.length, 0);
  std::ranges::sort(regions_, {}, &Region::begin);
  for (std::size_t i = 1; sound && i < regions_.size(); ++i)
    sound = regions_[i - 1].end <= regions_[i].begin;
  if (!sound)
    return fail("the summary's indexes point to impossible places",
                file_.at(frame_.footer->summary_start));
  return {};
}

/// Some writers give wrong places: npm's, for attachments among messages outside chunks.
bool Survey::is_record(std::uint64_t offset, std::uint8_t opcode, std::uint64_t length) const {
  if (offset < frame_.data_begin || offset > frame_.data_end || length < record_head ||
      length > frame_.data_end - offset)
    return false;
  const auto head = file_.read(offset, record_head);
  if (!head) return false;
  Cursor cursor(*head);
  return cursor.number<std::uint8_t>() == opcode &&
         cursor.number<std::uint64_t>() == length - record_head;
}

void Survey::walk_gaps() {
  std::uint64_t position = frame_.data_begin;
  for (const Region& region : regions_) {
    walk(position, region.begin);
    position = region.end;
  }
  walk(position, frame_.data_end);
  std::ranges::sort(contents_.chunks, {}, &ChunkIndex::chunk_start_offset);
}

void Survey::walk(std::uint64_t begin, std::uint64_t end) {
  RecordStream records(file_, begin, end);
  in_stretch_ = after_chunk_ = false;
  while (true) {
    const auto record = records.next();
    if (!record) {
      Error error = record.error();
      if (const std::uint64_t kept = salvage(records.position(), end))
        error.what += ", " + std::to_string(kept) + " messages of it could be read";
      (holds_data(records.position()) ? contents_.damage : contents_.remarks)
          .push_back(std::move(error));
      return;
    }
    if (!*record) return;
    if ((*record)->opcode == DataEnd::opcode) return note_what_follows(records.position());
    if ((*record)->opcode == 0) {
      if (!zeros_)
        contents_.damage.push_back({"zeros in place of a record", file_.at((*record)->offset),
                                    "as a disk leaves them that lost its power"});
      zeros_ = true;
      continue;
    }
    if (auto taken = take(**record); !taken)
      contents_.damage.push_back(at(file_, (*record)->offset, taken.error()).value());
  }
}

Expected<void> Survey::take(const RawRecord& raw) {
  if (raw.opcode == Chunk::opcode) return take_chunk(raw);
  const auto record = parse(raw.opcode, raw.content);
  if (!record) return tl::unexpected(record.error());
  const std::uint64_t length = raw.end() - raw.offset;
  if (const auto* message = std::get_if<Message>(&*record)) {
    take_message(raw, *message);
    return {};
  }
  if (const auto* index = std::get_if<MessageIndex>(&*record)) {
    if (!after_chunk_) return {};
    ChunkIndex& chunk = contents_.chunks.back();
    chunk.message_index_offsets.emplace_back(index->channel_id, raw.offset);
    chunk.message_index_length += length;
    return {};
  }
  if (const auto* schema = std::get_if<Schema>(&*record)) {
    if (schema->id != 0) contents_.schemas.emplace(schema->id, *schema);
    return {};
  }
  if (const auto* channel = std::get_if<Channel>(&*record)) {
    contents_.channels.emplace(channel->id, *channel);
    return {};
  }
  in_stretch_ = after_chunk_ = false;
  if (const auto* attachment = std::get_if<Attachment>(&*record))
    contents_.attachments.push_back({raw.offset, length, attachment->log_time,
                                     attachment->create_time, attachment->data.size(),
                                     attachment->name, attachment->media_type});
  else if (const auto* metadata = std::get_if<Metadata>(&*record))
    contents_.metadata.push_back({raw.offset, length, metadata->name});
  return {};
}

Expected<void> Survey::take_chunk(const RawRecord& raw) {
  in_stretch_ = after_chunk_ = false;
  const auto chunk = parse_as<Chunk>(raw.opcode, raw.content);
  if (!chunk) return tl::unexpected(chunk.error());
  const auto expanded = expand(*chunk);
  if (!expanded) return tl::unexpected(expanded.error());
  if (auto taken = take_inside(*expanded); !taken) return taken;
  contents_.chunks.push_back({.message_start_time = chunk->message_start_time,
                              .message_end_time = chunk->message_end_time,
                              .chunk_start_offset = raw.offset,
                              .chunk_length = raw.end() - raw.offset,
                              .compression = chunk->compression,
                              .compressed_size = chunk->records.size(),
                              .uncompressed_size = chunk->uncompressed_size});
  after_chunk_ = true;
  return {};
}

/// Schemas and channels of a chunk.
Expected<void> Survey::take_inside(View records) {
  ChunkRecords inside(records);
  while (true) {
    const auto each = inside.next();
    if (!each) return tl::unexpected(each.error());
    if (!*each) return {};
    const auto record = parse((*each)->opcode, (*each)->content);
    if (!record) return tl::unexpected(record.error());
    if (const auto* schema = std::get_if<Schema>(&*record))
      contents_.schemas.emplace(schema->id, *schema);
    else if (const auto* channel = std::get_if<Channel>(&*record))
      contents_.channels.emplace(channel->id, *channel);
  }
}

/// A chunk that begins here and whose end is missing becomes a stretch of its whole records.
/// Returns how many messages are in it.
std::uint64_t Survey::salvage(std::uint64_t offset, std::uint64_t end) {
  end = std::min(end, file_.size());
  if (end < offset + record_head) return 0;
  const auto bytes = file_.read(offset, end - offset);
  if (!bytes || bytes->front() != Chunk::opcode) return 0;
  Cursor cursor(View(*bytes).subspan(record_head));
  cursor.take(2 * sizeof(std::uint64_t));  // times, which messages know better
  const auto size = cursor.number<std::uint64_t>();
  cursor.take(sizeof(std::uint32_t));  // the CRC is of the whole
  const auto compression = compression_named(cursor.string());
  cursor.number<std::uint64_t>();
  if (!cursor.good() || !compression) return 0;
  const Bytes records = decompress_front(*compression, cursor.rest(), size);
  Stretch stretch{.begin = end - cursor.rest().size(), .compression = *compression};
  Statistics inside;
  ChunkRecords front(records);
  for (auto raw = front.next(); raw && *raw; raw = front.next()) {
    const auto record = parse((*raw)->opcode, (*raw)->content);
    if (!record) break;
    stretch.size = (*raw)->end();
    if (const auto* message = std::get_if<Message>(&*record))
      inside.count(message->channel_id, message->log_time);
  }
  if (!take_inside(View(records).first(stretch.size)) || inside.message_count == 0) return 0;
  stretch.end = *compression == Compression::none ? stretch.begin + stretch.size : end;
  stretch.message_start_time = inside.message_start_time;
  stretch.message_end_time = inside.message_end_time;
  contents_.stretches.push_back(stretch);
  return inside.message_count;
}

/// Does a record that is cut short here lose more than an index, which was made of the rest?
bool Survey::holds_data(std::uint64_t offset) const {
  const auto opcode = file_.read(offset, 1);
  if (!opcode) return true;
  switch (opcode->front()) {
    case MessageIndex::opcode:
    case ChunkIndex::opcode:
    case AttachmentIndex::opcode:
    case Statistics::opcode:
    case MetadataIndex::opcode:
    case SummaryOffset::opcode:
    case DataEnd::opcode:
    case Footer::opcode:
      return false;
    default:
      return true;
  }
}

/// Behind the end of the data come the summary, the footer and eight bytes; whatever comes then is
/// another recording, or what a disk had there.
void Survey::note_what_follows(std::uint64_t position) {
  RecordStream records(file_, position, file_.size());
  for (auto raw = records.next(); raw && *raw; raw = records.next()) {
    if ((*raw)->opcode != Footer::opcode) continue;
    const std::uint64_t ended = records.position() + magic.size();
    ended_ = ended <= file_.size();
    if (ended >= file_.size()) return;
    const auto next =
        file_.read(ended, std::min<std::uint64_t>(magic.size(), file_.size() - ended));
    contents_.damage.push_back(
        {std::to_string(file_.size() - ended) + " bytes after the recording's end are not read" +
             (next && is_magic(*next) ? ", another recording begins there" : ""),
         file_.at(ended), "`tail -c +" + std::to_string(ended + 1) + "` gives them"});
    return;
  }
}

void Survey::take_message(const RawRecord& raw, const Message& message) {
  after_chunk_ = false;
  if (!in_stretch_ || raw.offset - contents_.stretches.back().begin >= max_stretch)
    contents_.stretches.push_back({raw.offset, raw.end(), message.log_time, message.log_time});
  in_stretch_ = true;
  Stretch& stretch = contents_.stretches.back();
  stretch.end = raw.end();
  stretch.message_start_time = std::min(stretch.message_start_time, message.log_time);
  stretch.message_end_time = std::max(stretch.message_end_time, message.log_time);
}

}  // namespace

Expected<Contents> survey(const File& file) {
  DataSection frame;
  const auto header = read_header(file, frame);
  if (!header) return tl::unexpected(header.error());
  find_footer(file, frame);

  Contents contents{.header = *header};
  if (frame.footer) {
    Survey by_summary(file, frame, contents);
    if (auto taken = by_summary.take_summary(); taken) {
      contents.closed = true;
      by_summary.walk_gaps();
      return contents;
    } else {
      contents = Contents{.header = *header};
      contents.damage.push_back(taken.error());
    }
  }
  Survey by_walking(file, frame, contents);
  by_walking.walk_gaps();
  contents.closed = frame.footer || by_walking.ended();
  if (!contents.closed)
    contents.remarks.push_back({"the file has no end: its writer did not close it", file.name(),
                                "prehend recording recover makes it whole"});
  return contents;
}

Expected<Bytes> read_stretch(const File& file, const Stretch& stretch) {
  auto bytes = file.read(stretch.begin, stretch.end - stretch.begin);
  if (!bytes || stretch.compression == Compression::none) return bytes;
  Bytes records = decompress_front(stretch.compression, *bytes, stretch.size);
  if (records.size() < stretch.size) return fail("is not as it was", file.at(stretch.begin));
  return records;
}

Expected<Bytes> read_chunk(const File& file, const ChunkIndex& index) {
  const auto bytes = file.read(index.chunk_start_offset, index.chunk_length);
  if (!bytes) return tl::unexpected(bytes.error());
  ChunkRecords one(*bytes);
  const auto raw = one.next();
  if (!raw || !*raw)
    return fail("a chunk does not fill the place that the index gives it",
                file.at(index.chunk_start_offset));
  const auto chunk = parse_as<Chunk>((*raw)->opcode, (*raw)->content);
  if (!chunk) return at(file, index.chunk_start_offset, chunk.error());
  auto records = expand(*chunk);
  if (!records) return at(file, index.chunk_start_offset, records.error());
  return records;
}

tl::unexpected<Error> at(const File& file, std::uint64_t offset, Error error) {
  error.where = file.at(offset) + (error.where.empty() ? "" : ", " + error.where);
  return tl::unexpected(std::move(error));
}

}  // namespace prehend::recording::mcap
