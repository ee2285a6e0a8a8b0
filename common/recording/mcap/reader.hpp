#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/mcap/compression.hpp"
#include "common/recording/mcap/file.hpp"
#include "common/recording/mcap/record.hpp"

namespace prehend::recording::mcap {

/// Bytes of a file from `begin` to `end` with records among which messages lie outside chunks that
/// are whole: between chunks, or in the front of one whose end is missing.
struct Stretch {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t message_start_time = 0;
  std::uint64_t message_end_time = 0;
  Compression compression = Compression::none;
  std::uint64_t size = 0;  // of the whole records, where they are compressed
};

/// What is in a file and where.
struct Contents {
  Header header;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::vector<ChunkIndex> chunks;  // in order of the file, as the stretches are
  std::vector<Stretch> stretches;
  std::vector<AttachmentIndex> attachments;
  std::vector<MetadataIndex> metadata;
  std::optional<Statistics> statistics;
  /// It has a footer: the writer was able to close it.
  bool closed = false;
  /// What could not be read, first things first; what could is in the fields above.
  std::vector<Error> damage;
  /// What is odd, but lost nothing.
  std::vector<Error> remarks;
};

/// What the messages of a file are, whatever its summary says of them.
struct Measured {
  Statistics statistics;
  std::vector<Error> damage;   // parts that cannot be read
  std::vector<Error> remarks;  // what the file says of itself and is not so
};

/// Which messages are wanted.
struct Selection {
  std::uint64_t start = 0;                                        // log time, inclusive
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();  // inclusive
  /// Channels to keep; empty: all.
  std::function<bool(const Channel&)> wanted;
};

class MessageCursor;

/// Reads an MCAP file, with or without index, whole or cut short. What its summary does not cover
/// is found by walking through it once. Lengths and offsets in the file are checked before they are
/// used; counts and times are taken from the messages themselves, which are read once for that. Not
/// thread safe; several readers of one file are.
class Reader {
 public:
  /// Fails when it is not an MCAP file of this major version or cannot be read. Everything less is
  /// `contents().damage`.
  static Expected<Reader> open(const std::filesystem::path& path);

  const Contents& contents() const { return *contents_; }
  const File& file() const { return *file_; }

  /// Counts and times of all messages that can be read.
  const Measured& measured();
  const Statistics& statistics() { return measured().statistics; }

  /// Messages in order of log time, in order of the file where it is the same. Several cursors may
  /// be open; each must not outlive the reader.
  MessageCursor messages(Selection selection = {});

  /// Its data points into `buffer`.
  Expected<Attachment> attachment(const AttachmentIndex& index, Bytes& buffer) const;
  Expected<Metadata> metadata(const MetadataIndex& index) const;

 private:
  Reader(File file);
  friend class MessageCursor;

  // Behind pointers, so that cursors survive a move.
  std::unique_ptr<File> file_;
  std::unique_ptr<Contents> contents_;
  std::unique_ptr<Measured> measured_;
};

/// A message with its channel; both are valid until the cursor moves on.
struct ReadMessage {
  const Channel* channel = nullptr;
  Message message;
};

class MessageCursor {
 public:
  MessageCursor(MessageCursor&&) noexcept;
  MessageCursor& operator=(MessageCursor&&) noexcept;
  ~MessageCursor();

  /// The next message, nothing at the end. A failure is a chunk or a message that cannot be read;
  /// it names its place, and the next call goes on behind it.
  Expected<std::optional<ReadMessage>> next();

 private:
  friend class Reader;
  MessageCursor(const File& file, Contents& contents, Selection selection);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace prehend::recording::mcap
