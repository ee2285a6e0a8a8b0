#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/recorder/service/recording_file.hpp"

namespace prehend::recorder {

/// A sample in memory. Copies share it, so that a ring of many is copied in no time.
struct KeptSample {
  const Source* source;
  std::shared_ptr<const dds::RawSample> sample;
  std::uint64_t size() const { return sample->payload.size() + 160; }
};

/// Fails when the disk of a file would have less than `keep_free` bytes left after `bytes` more.
/// A disk that does not tell counts as empty enough.
Expected<void> check_space(const std::filesystem::path& file, std::uint64_t bytes,
                           std::uint64_t keep_free);

/// What a recorder held at one moment. Writing it takes as long as the disk does, and needs nothing
/// of the recorder: samples come on meanwhile.
struct Snapshot {
  struct Written {
    std::filesystem::path path;
    std::uint64_t messages = 0, bytes = 0;
  };
  /// To a new file. What could not be written whole is removed.
  Expected<Written> write() const;

  std::filesystem::path path;
  const Heading* heading;
  recording::mcap::Compression compression;
  std::uint64_t keep_free;
  Time start;                    // stamp of what is older
  std::vector<KeptSample> head;  // what a late reader at the start would be given
  std::deque<KeptSample> ring;
  std::map<std::string, std::uint64_t> lost;

 private:
  Expected<Written> write_all() const;
};

}  // namespace prehend::recorder
