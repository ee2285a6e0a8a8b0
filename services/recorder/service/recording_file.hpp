#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/dds/raw.hpp"
#include "common/recording/mcap/writer.hpp"

namespace prehend::recorder {

/// A topic that is recorded. Its address stands for it.
struct Source {
  dds::RawTopic topic;
  std::string rig;
};

/// How a type is described to readers of the file.
struct Description {
  recording::mcap::Schema schema;  // without id
  std::string idl;                 // one self-contained text
};

/// What is written at the head of every file.
struct Heading {
  std::map<std::string, std::string> configuration;  // lab.toml, as it was in force
  std::string scene;                                 // text of the scene file; empty: none
  /// Nothing for types that nobody has described.
  std::function<std::optional<Description>(const std::string& type)> describe;
  std::string catalogue = {};  // text of the catalogue; empty: that of the programs
};

/// An MCAP file that is being written, in the layout of common/recording/layout. Keeps a reference
/// to the heading.
class RecordingFile {
 public:
  static Expected<RecordingFile> create(const std::filesystem::path& path, const Heading& heading,
                                        recording::mcap::Compression compression);

  Expected<void> write(const Source& source, const dds::RawSample& sample, Time log_time);
  /// Samples lost so far, by topic; the last one in a file counts.
  Expected<void> write_losses(const std::map<std::string, std::uint64_t>& losses);
  Expected<void> flush() { return writer_.flush(); }
  Expected<void> close() { return writer_.close(); }

  std::uint64_t size() const { return writer_.size(); }
  std::uint64_t messages() const { return writer_.statistics().message_count; }
  /// Channels are numbered with 16 bits, and the file's index is kept in memory: a file that has
  /// most of either needs a successor.
  bool is_full() const { return channels_.size() >= 60000 || writer_.index_size() >= 16'000'000; }

 private:
  struct Key {
    const Source* source;
    dds::RawSample::Kind kind;
    dds::Guid writer, instance;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };

  RecordingFile(recording::mcap::Writer writer, const Heading& heading)
      : writer_(std::move(writer)), heading_(&heading) {}
  Expected<std::uint16_t> channel(const Key& key);
  Expected<std::uint16_t> schema(const std::string& type);

  recording::mcap::Writer writer_;
  const Heading* heading_;
  std::unordered_map<Key, std::uint16_t, Hash> channels_;
  std::map<std::string, std::uint16_t> schemas_;
};

}  // namespace prehend::recorder
