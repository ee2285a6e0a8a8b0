#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/recording/mcap/file.hpp"
#include "common/recording/mcap/record.hpp"

namespace prehend::recording::mcap {

/// What to do about a file whose parts contradict each other.
inline constexpr const char* damage_hint = "prehend recording recover keeps what can be read";

/// The records of a part of a file, one after the other, as they lie there. Needs no summary and
/// no footer. The file must outlive it.
class RecordStream {
 public:
  /// From `begin` up to `end` (at most the file's end).
  RecordStream(const File& file, std::uint64_t begin, std::uint64_t end);

  /// The next record, whose content stays valid until the next call; nothing at the end of the
  /// part. A record that does not end inside the part is a failure that names its offset, and so is
  /// every further call.
  Expected<std::optional<RawRecord>> next();

  /// Where the next record starts: behind the last whole one.
  std::uint64_t position() const { return position_; }

 private:
  struct Head {
    std::uint8_t opcode = 0;
    std::uint64_t offset = 0;
    std::uint64_t end = 0;  // of its content
  };
  /// Puts these bytes of the file into the buffer; they end inside the part.
  Expected<View> bytes(std::uint64_t offset, std::uint64_t count);
  Expected<std::optional<Head>> head();

  const File& file_;
  std::uint64_t position_, end_;
  Bytes buffer_;
  std::uint64_t buffer_start_ = 0;
};

/// The records inside a chunk that was decompressed.
class ChunkRecords {
 public:
  explicit ChunkRecords(View records) : records_(records) {}
  /// The offset of a record is that in the chunk.
  Expected<std::optional<RawRecord>> next();

 private:
  View records_;
  std::uint64_t position_ = 0;
};

/// Decompresses a chunk and checks its CRC.
Expected<Bytes> expand(const Chunk& chunk);

}  // namespace prehend::recording::mcap
