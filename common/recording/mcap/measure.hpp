#pragma once

#include "common/recording/mcap/reader.hpp"

namespace prehend::recording::mcap {

/// Reads all messages once. The times of chunks in `contents` become those of their messages, and
/// schemas and channels that only chunks have are added.
Measured measure(const File& file, Contents& contents);

}  // namespace prehend::recording::mcap
