#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"

namespace prehend::recorder {

/// What a new recording takes from others.
struct CopyOptions {
  recording::mcap::Selection selection;   // topics and times
  recording::mcap::WriterOptions writer;  // how the new file is written
  /// Called now and then with the share that is done, 0 to 1.
  std::function<void(double)> progress;
};

struct CopyResult {
  std::uint64_t messages = 0;
  std::vector<Error> damage;   // what of the sources could not be read
  std::vector<Error> remarks;  // what is odd in them, but lost nothing
};

/// Writes one recording with the messages of several in order of log time, their schemas and
/// channels (those that are the same once), attachments and metadata; counts of losses are summed.
/// A part that begins later begins with what a late reader would then be given on transient local
/// topics, as the parts of a split recording do: at the log time at which it begins.
/// The file appears under its name when it is whole. Fails when it cannot be written, or would
/// replace one of the sources.
Expected<CopyResult> copy(std::vector<recording::mcap::Reader>& sources,
                          const std::filesystem::path& to, const CopyOptions& options);

}  // namespace prehend::recorder
