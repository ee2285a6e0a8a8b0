#include "common/recording/mcap/record.hpp"

#include <libdeflate.h>

#include <algorithm>

namespace prehend::recording::mcap {
namespace {

// Each record lists its fields once, in the order of the specification; reading and writing both
// walk that list.
void fields(auto& io, auto& r, Header*) {
  io(r.profile, r.library);
}
void fields(auto& io, auto& r, Footer*) {
  io(r.summary_start, r.summary_offset_start, r.summary_crc);
}
void fields(auto& io, auto& r, Schema*) {
  io(r.id, r.name, r.encoding, r.data);
}
void fields(auto& io, auto& r, Channel*) {
  io(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
}
void fields(auto& io, auto& r, Message*) {
  io(r.channel_id, r.sequence, r.log_time, r.publish_time);
  io.remainder(r.data);
}
void fields(auto& io, auto& r, Chunk*) {
  io(r.message_start_time, r.message_end_time, r.uncompressed_size, r.uncompressed_crc,
     r.compression, r.records);
}
void fields(auto& io, auto& r, MessageIndex*) {
  io(r.channel_id, r.records);
}
void fields(auto& io, auto& r, ChunkIndex*) {
  io(r.message_start_time, r.message_end_time, r.chunk_start_offset, r.chunk_length,
     r.message_index_offsets, r.message_index_length, r.compression, r.compressed_size,
     r.uncompressed_size);
}
void fields(auto& io, auto& r, Attachment*) {
  io(r.log_time, r.create_time, r.name, r.media_type, r.data);
  io.checksum(r.crc);
}
void fields(auto& io, auto& r, AttachmentIndex*) {
  io(r.offset, r.length, r.log_time, r.create_time, r.data_size, r.name, r.media_type);
}
void fields(auto& io, auto& r, Statistics*) {
  io(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count,
     r.chunk_count, r.message_start_time, r.message_end_time, r.channel_message_counts);
}
void fields(auto& io, auto& r, Metadata*) {
  io(r.name, r.metadata);
}
void fields(auto& io, auto& r, MetadataIndex*) {
  io(r.offset, r.length, r.name);
}
void fields(auto& io, auto& r, SummaryOffset*) {
  io(r.group_opcode, r.group_start, r.group_length);
}
void fields(auto& io, auto& r, DataEnd*) {
  io(r.data_section_crc);
}

class FieldReader {
 public:
  explicit FieldReader(View content) : cursor_(content) {}

  void operator()(auto&... field) { (read(field), ...); }
  void remainder(View& bytes) { bytes = cursor_.take(cursor_.rest().size()); }
  void checksum(std::uint32_t& crc) { read(crc); }
  bool good() const { return good_ && cursor_.good(); }

 private:
  template <class Number>
  requires std::is_integral_v<Number>
  void read(Number& number) { number = cursor_.number<Number>(); }
  void read(std::string& string) { string = cursor_.string(); }
  void read(View& bytes) { bytes = cursor_.take(cursor_.number<std::uint64_t>()); }
  // A map or array: its length in bytes, then its entries.
  template <class First, class Second>
  void read(std::vector<std::pair<First, Second>>& entries) {
    Cursor inside(cursor_.take(cursor_.number<std::uint32_t>()));
    std::swap(inside, cursor_);
    while (cursor_.more()) {
      auto& [first, second] = entries.emplace_back();
      read(first);
      read(second);
    }
    good_ = good_ && cursor_.good();
    std::swap(inside, cursor_);
  }

  Cursor cursor_;
  bool good_ = true;
};

class FieldWriter {
 public:
  explicit FieldWriter(Bytes& out) : out_(out), start_(out.size()) {}

  void operator()(const auto&... field) { (write(field), ...); }
  void remainder(View bytes) { append(out_, bytes); }
  void checksum(std::uint32_t) { append(out_, crc32(View(out_).subspan(start_))); }

 private:
  template <class Number>
  requires std::is_integral_v<Number>
  void write(Number number) { append(out_, number); }
  void write(const std::string& string) { append_string(out_, string); }
  void write(View bytes) {
    append(out_, static_cast<std::uint64_t>(bytes.size()));
    append(out_, bytes);
  }
  template <class First, class Second>
  void write(const std::vector<std::pair<First, Second>>& entries) {
    const std::size_t length_at = out_.size();
    append(out_, std::uint32_t{0});
    for (const auto& [first, second] : entries) {
      write(first);
      write(second);
    }
    overwrite(out_, length_at, static_cast<std::uint32_t>(out_.size() - length_at - 4));
  }

  Bytes& out_;
  std::size_t start_;
};

}  // namespace

std::string_view find(const StringMap& map, std::string_view key) {
  const auto entry = std::ranges::find(map, key, &StringMap::value_type::first);
  return entry == map.end() ? std::string_view{} : entry->second;
}

void Statistics::count(std::uint16_t channel, std::uint64_t log_time) {
  message_start_time = message_count == 0 ? log_time : std::min(message_start_time, log_time);
  message_end_time = message_count == 0 ? log_time : std::max(message_end_time, log_time);
  ++message_count;
  if (channel >= places.size()) places.resize(channel + std::size_t{1});
  if (places[channel] == 0) {
    channel_message_counts.emplace_back(channel, 0);
    places[channel] = static_cast<std::uint32_t>(channel_message_counts.size());
  }
  ++channel_message_counts[places[channel] - 1].second;
}

template <class Type>
Expected<Type> parse_as(std::uint8_t opcode, View content) {
  if (opcode != Type::opcode)
    return fail("a record of another kind (opcode " + std::to_string(opcode) + " instead of " +
                std::to_string(Type::opcode) + ")");
  Type record;
  FieldReader reader(content);
  fields(reader, record, static_cast<Type*>(nullptr));
  if (!reader.good())
    return fail("a record (opcode " + std::to_string(opcode) + ") is shorter than its fields");
  return record;
}

template <class Type>
void append_record(Bytes& out, const Type& record, View padding) {
  append(out, Type::opcode);
  const std::size_t length_at = out.size();
  append(out, std::uint64_t{0});
  FieldWriter writer(out);
  fields(writer, record, static_cast<Type*>(nullptr));
  append(out, padding);
  overwrite(out, length_at, static_cast<std::uint64_t>(out.size() - length_at - 8));
}

namespace {

template <class Type>
bool parse_if(std::uint8_t opcode, View content, Expected<Record>& result) {
  if (opcode != Type::opcode) return false;
  result = parse_as<Type>(opcode, content);
  return true;
}

template <class First, class... Types>
Expected<Record> parse_any(std::uint8_t opcode, View content, std::variant<First, Types...>*) {
  Expected<Record> result = Unknown{opcode, content};
  (parse_if<Types>(opcode, content, result) || ...);
  return result;
}

}  // namespace

Expected<Record> parse(std::uint8_t opcode, View content) {
  return parse_any(opcode, content, static_cast<Record*>(nullptr));
}

std::uint32_t crc32(View bytes, std::uint32_t before) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

template Expected<Header> parse_as(std::uint8_t, View);
template Expected<Footer> parse_as(std::uint8_t, View);
template Expected<Schema> parse_as(std::uint8_t, View);
template Expected<Channel> parse_as(std::uint8_t, View);
template Expected<Message> parse_as(std::uint8_t, View);
template Expected<Chunk> parse_as(std::uint8_t, View);
template Expected<MessageIndex> parse_as(std::uint8_t, View);
template Expected<ChunkIndex> parse_as(std::uint8_t, View);
template Expected<Attachment> parse_as(std::uint8_t, View);
template Expected<AttachmentIndex> parse_as(std::uint8_t, View);
template Expected<Statistics> parse_as(std::uint8_t, View);
template Expected<Metadata> parse_as(std::uint8_t, View);
template Expected<MetadataIndex> parse_as(std::uint8_t, View);
template Expected<SummaryOffset> parse_as(std::uint8_t, View);
template Expected<DataEnd> parse_as(std::uint8_t, View);

template void append_record(Bytes&, const Header&, View);
template void append_record(Bytes&, const Footer&, View);
template void append_record(Bytes&, const Schema&, View);
template void append_record(Bytes&, const Channel&, View);
template void append_record(Bytes&, const Message&, View);
template void append_record(Bytes&, const Chunk&, View);
template void append_record(Bytes&, const MessageIndex&, View);
template void append_record(Bytes&, const ChunkIndex&, View);
template void append_record(Bytes&, const Attachment&, View);
template void append_record(Bytes&, const AttachmentIndex&, View);
template void append_record(Bytes&, const Statistics&, View);
template void append_record(Bytes&, const Metadata&, View);
template void append_record(Bytes&, const MetadataIndex&, View);
template void append_record(Bytes&, const SummaryOffset&, View);
template void append_record(Bytes&, const DataEnd&, View);

}  // namespace prehend::recording::mcap
