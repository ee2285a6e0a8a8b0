#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/mcap/bytes.hpp"

namespace prehend::recording::mcap {

enum class Compression { none, lz4, zstd };

/// The name in a chunk: "", lz4 or zstd.
std::string_view name(Compression compression);
/// Fails on a name this version does not know.
Expected<Compression> compression_named(std::string_view name);

/// Appends the compressed bytes (a frame of LZ4 or Zstandard, at its fastest level).
Expected<void> compress(Compression compression, View bytes, Bytes& out);

/// The bytes of a chunk, which must come to exactly `size`. Memory grows with what really comes
/// out, so a size that lies costs nothing.
Expected<Bytes> decompress(Compression compression, View bytes, std::uint64_t size);

/// Of a chunk whose end is missing, the bytes up to there: as many as come out, at most `size`.
Bytes decompress_front(Compression compression, View bytes, std::uint64_t size);

}  // namespace prehend::recording::mcap
