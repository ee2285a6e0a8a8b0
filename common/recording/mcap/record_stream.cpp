#include "common/recording/mcap/record_stream.hpp"

#include <algorithm>

#include "common/recording/mcap/compression.hpp"

namespace prehend::recording::mcap {
namespace {

constexpr std::uint64_t block = 256 * 1024;

}  // namespace

RecordStream::RecordStream(const File& file, std::uint64_t begin, std::uint64_t end)
    : file_(file), position_(begin), end_(std::min(end, file.size())) {}

Expected<View> RecordStream::bytes(std::uint64_t offset, std::uint64_t count) {
  const bool there = offset >= buffer_start_ && offset - buffer_start_ <= buffer_.size() &&
                     count <= buffer_.size() - (offset - buffer_start_);
  if (!there) {
    const std::uint64_t wanted = std::max(count, std::min(block, end_ - offset));
    auto read = file_.read(offset, wanted);
    if (!read) return tl::unexpected(read.error());
    buffer_ = std::move(*read);
    buffer_start_ = offset;
  }
  return View(buffer_).subspan(offset - buffer_start_, count);
}

Expected<std::optional<RecordStream::Head>> RecordStream::head() {
  if (position_ >= end_) return std::nullopt;
  const auto cut = [&] {
    return fail("the last record is cut short", file_.at(position_),
                "prehend recording recover makes a whole file of the rest");
  };
  if (end_ - position_ < record_head) return cut();
  const auto front = bytes(position_, record_head);
  if (!front) return tl::unexpected(front.error());
  Cursor cursor(*front);
  Head head{cursor.number<std::uint8_t>(), position_, 0};
  const auto length = cursor.number<std::uint64_t>();
  if (length > end_ - position_ - record_head) return cut();
  head.end = position_ + record_head + length;
  return head;
}

Expected<std::optional<RawRecord>> RecordStream::next() {
  const auto found = head();
  if (!found) return tl::unexpected(found.error());
  if (!*found) return std::nullopt;
  const std::uint64_t start = (*found)->offset + record_head;
  const auto content = bytes(start, (*found)->end - start);
  if (!content) return tl::unexpected(content.error());
  position_ = (*found)->end;
  return RawRecord{(*found)->opcode, (*found)->offset, *content};
}

Expected<std::optional<RawRecord>> ChunkRecords::next() {
  if (position_ == records_.size()) return std::nullopt;
  Cursor cursor(records_.subspan(position_));
  const auto opcode = cursor.number<std::uint8_t>();
  const View content = cursor.take(cursor.number<std::uint64_t>());
  if (!cursor.good())
    return fail("damaged: a record does not end inside its chunk",
                "byte " + std::to_string(position_) + " of the chunk", damage_hint);
  const RawRecord record{opcode, position_, content};
  position_ = record.end();
  return record;
}

Expected<Bytes> expand(const Chunk& chunk) {
  const auto compression = compression_named(chunk.compression);
  if (!compression) return tl::unexpected(compression.error());
  auto records = decompress(*compression, chunk.records, chunk.uncompressed_size);
  if (records && chunk.uncompressed_crc != 0 && crc32(*records) != chunk.uncompressed_crc)
    return fail("damaged: the bytes of a chunk were changed, its CRC is wrong", {}, damage_hint);
  return records;
}

}  // namespace prehend::recording::mcap
