#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/mcap/bytes.hpp"

/// Records of an MCAP file, as https://mcap.dev/spec defines them. Times are nanoseconds since the
/// epoch, offsets count from the start of the file.
namespace prehend::recording::mcap {

inline constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
/// Bytes before the content of a record: its opcode and its length.
inline constexpr std::size_t record_head = 9;
/// A footer has a fixed length, so it is found from the end of the file.
inline constexpr std::size_t footer_content = 20;

/// Maps keep the order of the file, so that a record written again is the same bytes.
using StringMap = std::vector<std::pair<std::string, std::string>>;
using CountMap = std::vector<std::pair<std::uint16_t, std::uint64_t>>;

/// The value of a key, empty where there is none.
std::string_view find(const StringMap& map, std::string_view key);

struct Header {
  static constexpr std::uint8_t opcode = 0x01;
  std::string profile;
  std::string library;
};

struct Footer {
  static constexpr std::uint8_t opcode = 0x02;
  std::uint64_t summary_start = 0;  // 0: there is none
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;  // CRCs: 0 is «not computed»
};

struct Schema {
  static constexpr std::uint8_t opcode = 0x03;
  std::uint16_t id = 0;  // never 0
  std::string name;
  std::string encoding;
  std::string data;
};

struct Channel {
  static constexpr std::uint8_t opcode = 0x04;
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  // 0: without schema
  std::string topic;
  std::string message_encoding;
  StringMap metadata;
};

struct Message {
  static constexpr std::uint8_t opcode = 0x05;
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::uint64_t publish_time = 0;
  View data;  // of the buffer that it was read from
};

struct Chunk {
  static constexpr std::uint8_t opcode = 0x06;
  std::uint64_t message_start_time = 0;
  std::uint64_t message_end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;  // "", lz4 or zstd
  View records;
};

struct MessageIndex {
  static constexpr std::uint8_t opcode = 0x07;
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> records;  // log time, offset in the chunk
};

struct ChunkIndex {
  static constexpr std::uint8_t opcode = 0x08;
  std::uint64_t message_start_time = 0;
  std::uint64_t message_end_time = 0;
  std::uint64_t chunk_start_offset = 0;
  std::uint64_t chunk_length = 0;  // with the head of the record
  CountMap message_index_offsets;  // by channel
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct Attachment {
  static constexpr std::uint8_t opcode = 0x09;
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::string name;
  std::string media_type;
  View data;
  std::uint32_t crc = 0;  // of all before it; computed when it is written
};

struct AttachmentIndex {
  static constexpr std::uint8_t opcode = 0x0A;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::uint64_t data_size = 0;
  std::string name;
  std::string media_type;
};

struct Statistics {
  static constexpr std::uint8_t opcode = 0x0B;
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t message_start_time = 0;
  std::uint64_t message_end_time = 0;
  CountMap channel_message_counts;

  /// Takes a message into the counts and times, at the same cost however many channels there are.
  void count(std::uint16_t channel, std::uint64_t log_time);
  /// Of count() alone: by channel, 1 + its place in the counts; 0: it has none.
  std::vector<std::uint32_t> places;
};

struct Metadata {
  static constexpr std::uint8_t opcode = 0x0C;
  std::string name;
  StringMap metadata;
};

struct MetadataIndex {
  static constexpr std::uint8_t opcode = 0x0D;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::string name;
};

struct SummaryOffset {
  static constexpr std::uint8_t opcode = 0x0E;
  std::uint8_t group_opcode = 0;
  std::uint64_t group_start = 0;
  std::uint64_t group_length = 0;
};

struct DataEnd {
  static constexpr std::uint8_t opcode = 0x0F;
  std::uint32_t data_section_crc = 0;
};

/// A record that this version does not know; readers pass it by.
struct Unknown {
  std::uint8_t opcode = 0;
  View content;
};

using Record = std::variant<Unknown, Header, Footer, Schema, Channel, Message, Chunk, MessageIndex,
                            ChunkIndex, Attachment, AttachmentIndex, Statistics, Metadata,
                            MetadataIndex, SummaryOffset, DataEnd>;

/// A record still in bytes.
struct RawRecord {
  std::uint8_t opcode = 0;
  std::uint64_t offset = 0;  // of its head
  View content;
  /// Behind its last byte.
  std::uint64_t end() const { return offset + record_head + content.size(); }
};

/// The fields of a record. Data beyond the known fields is ignored, as the specification asks of
/// readers. Fails when fields are missing. Views point into `content`.
Expected<Record> parse(std::uint8_t opcode, View content);

/// A record of the given type; another opcode than the type's is a failure too.
template <class Type>
Expected<Type> parse_as(std::uint8_t opcode, View content);

/// Appends a record with its head and, behind its fields, the padding (readers ignore it; footers,
/// messages, chunks and data ends cannot have any).
template <class Type>
void append_record(Bytes& out, const Type& record, View padding = {});

/// CRC-32 as in zlib; `before` is that of the bytes in front.
std::uint32_t crc32(View bytes, std::uint32_t before = 0);

}  // namespace prehend::recording::mcap
