#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/recording/mcap/compression.hpp"
#include "common/recording/mcap/file.hpp"
#include "common/recording/mcap/record.hpp"

namespace prehend::recording::mcap {

/// What of the specification's optional parts a file gets. The defaults are what readers like best.
struct WriterOptions {
  /// The profile that the header names; empty: none.
  std::string profile;
  /// Who wrote the file, as the header says.
  std::string library = "prehend";
  /// Of chunks; files without chunks are not compressed.
  Compression compression = Compression::zstd;
  /// Messages stand in chunks, which can be compressed and found by time.
  bool chunks = true;
  /// A chunk is closed by the message with which it reaches this size, ...
  std::uint64_t chunk_bytes = 1024 * 1024;
  /// ... or spans this much log time. What is in an open chunk is lost when the process is killed.
  Duration chunk_duration = std::chrono::milliseconds(500);
  /// Behind each chunk stands where in it the messages of each channel are.
  bool message_index = true;
  /// The summary says where each chunk is, and of which time.
  bool chunk_index = true;
  /// The summary says how many messages there are.
  bool statistics = true;
  /// The summary repeats all schemas, so that a reader needs no other part of the file for them.
  bool repeated_schemas = true;
  /// The same of the channels.
  bool repeated_channels = true;
  /// The summary says where attachments are.
  bool attachment_index = true;
  /// The same of metadata.
  bool metadata_index = true;
  /// Behind the summary stands where each kind of record begins in it.
  bool summary_offsets = true;
  /// Check sums of chunks, of the data and of the summary; without, they are 0.
  bool crcs = true;
  /// Bytes behind the fields of every record that may have such outside chunks. Readers pass them
  /// by; the specification's conformance tests want them.
  Bytes padding;
};

/// Writes an MCAP file from front to back. Whatever was flushed is readable after a crash. Not
/// thread safe. After a failure to write (a full disk) the file stays whole up to the last flush
/// and every further call fails with the same error.
class Writer {
 public:
  static Expected<Writer> create(const std::filesystem::path& path, WriterOptions options = {});
  Writer(Writer&&) noexcept = default;
  Writer& operator=(Writer&&) = delete;
  /// Closes; call close() to learn whether that worked.
  ~Writer();

  /// With an id of its own (the same content gets a new id each time).
  Expected<std::uint16_t> add_schema(std::string name, std::string encoding, std::string data);
  Expected<std::uint16_t> add_channel(std::uint16_t schema_id, std::string topic,
                                      std::string message_encoding, StringMap metadata = {});
  /// With the id given; fails when that id is taken by something else.
  Expected<void> write(const Schema& schema);
  Expected<void> write(const Channel& channel);

  /// Fails on a channel that was not added.
  Expected<void> write(const Message& message);
  /// Written at once, after the chunk that is open.
  Expected<void> write(const Attachment& attachment);
  Expected<void> write(const Metadata& metadata);

  /// Hands everything so far to the operating system: it survives the end of this process. A
  /// recorder calls it at least once a second.
  Expected<void> flush();
  /// The same, and waits until it is on the disk: it survives a power cut.
  Expected<void> sync();
  /// Writes the summary. The second call does nothing.
  Expected<void> close();

  /// Bytes in the file and in the chunk that is open.
  std::uint64_t size() const { return file_.size() + pending_.size() + chunk_.size(); }
  /// Bytes of the summary's indexes, which are kept in memory until close().
  std::uint64_t index_size() const {
    return chunk_index_records_.size() + attachment_index_records_.size() +
           metadata_index_records_.size();
  }
  const Statistics& statistics() const { return statistics_; }

 private:
  Writer(File file, WriterOptions options);

  /// To the open chunk, or straight to the file.
  template <class Type>
  void append_data(const Type& record);
  Expected<void> close_chunk();
  /// Writes `pending_`.
  Expected<void> put();
  Expected<void> write_summary();
  /// Where the next byte behind `pending_` will lie.
  std::uint64_t position() const { return file_.size() + pending_.size(); }

  File file_;
  WriterOptions options_;
  Bytes pending_;  // whole records, not yet written
  Bytes chunk_;    // records of the open chunk
  Bytes compressed_;
  std::optional<std::pair<std::uint64_t, std::uint64_t>> chunk_times_;
  std::vector<MessageIndex> chunk_indexes_;  // of the open chunk, in order of first message
  std::vector<std::uint32_t> index_places_;  // by channel, 1 + its place there; 0: it has none
  std::uint32_t data_crc_ = 0;
  Statistics statistics_;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::map<std::uint16_t, std::size_t> schema_places_, channel_places_;
  // The summary's index records, as bytes: they are many in a long file.
  Bytes chunk_index_records_, attachment_index_records_, metadata_index_records_;
  std::optional<Error> broken_;
  bool closed_ = false;
};

}  // namespace prehend::recording::mcap
