#pragma once

#include <filesystem>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::recorder {

/// Reads every byte of a recording and holds it against the specification: that all records parse,
/// CRCs of chunks, attachments, data and summary, that messages have channels and channels schemas,
/// and that indexes, statistics and offsets say what is there. Returns what is wrong, in the order
/// of the file; nothing: sound. Fails when it is not an MCAP file.
Expected<std::vector<Error>> verify(const std::filesystem::path& file);

}  // namespace prehend::recorder
