#pragma once

#include "common/base/error.hpp"
#include "common/recording/mcap/reader.hpp"

namespace prehend::recording::mcap {

/// Finds out what is in a file: from its summary as far as that is sound, else by walking through
/// the records. Fails only when the file is not an MCAP file of this version.
Expected<Contents> survey(const File& file);

/// A chunk of the file as it was indexed, decompressed and checked.
Expected<Bytes> read_chunk(const File& file, const ChunkIndex& index);

/// The records of a stretch, whole ones.
Expected<Bytes> read_stretch(const File& file, const Stretch& stretch);

/// The same failure, said to be at this place of the file.
tl::unexpected<Error> at(const File& file, std::uint64_t offset, Error error);

}  // namespace prehend::recording::mcap
