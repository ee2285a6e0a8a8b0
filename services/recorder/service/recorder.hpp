#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "services/recorder/service/snapshot.hpp"

namespace prehend::recorder {

struct RecorderOptions {
  std::filesystem::path file;                   // the second one of NAME.mcap is NAME_1.mcap
  std::uint64_t split_bytes = 4'000'000'000;    // of a file, then the next one begins
  Duration split_time = std::chrono::hours(6);  // an index of the file is kept in memory
  int keep_files = 0;                           // of a split recording, the newest; 0: all
  std::uint64_t keep_free = 200'000'000;        // bytes of the disk
  /// More than 0: a ring of so much time is kept in memory and written on request.
  Duration snapshot{};
  std::uint64_t snapshot_bytes = 512'000'000;  // of the ring, at most
  recording::mcap::Compression compression = recording::mcap::Compression::zstd;  // of the files
};

/// What a recorder does with samples: files, splits, snapshots, losses. Knows no DDS, thread or
/// clock. Once something has failed (a full disk) it stays so: error() tells.
class Recorder {
 public:
  /// Opens the first file, unless it is for snapshots. The heading must outlive it.
  static Expected<Recorder> create(RecorderOptions options, const Heading& heading, Time now);

  /// The source must outlive the recorder.
  void take(const Source& source, dds::RawSample&& sample);
  /// Samples of the topic that are known to be lost, since the start.
  void set_lost(const std::string& topic, std::uint64_t total) { lost_[topic] = total; }
  /// To be called several times a second: writes out twice a second what is there, watches the
  /// disk.
  void tick(Time now);

  /// What is received from now on, until resume(), is left out: also what is taken later.
  void pause(Time now);
  void resume(Time now);
  bool paused() const { return pause_end_ == Time::max() && pause_begin_ != Time::max(); }
  /// What the ring holds, to be written to a file of its own without the recorder. Quick.
  Expected<Snapshot> snapshot(Time now);
  /// One that was written counts.
  void add(const Snapshot::Written& snapshot);
  /// Ends the file properly. Fails when it could not be ended so or had failed before; the file is
  /// readable all the same.
  Expected<void> close();

  const std::optional<Error>& error() const { return error_; }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t bytes() const { return written_ + (file_ ? file_->size() : 0); }
  std::uint64_t lost() const;
  /// Held in memory for snapshots.
  std::uint64_t ring_bytes() const { return ring_bytes_; }
  const std::filesystem::path& path() const { return path_; }
  const std::deque<std::filesystem::path>& files() const { return files_; }

 private:
  struct InstanceKey {
    const Source* source;
    dds::Guid writer, instance;
    auto operator<=>(const InstanceKey&) const = default;
  };

  Recorder(RecorderOptions options, const Heading& heading)
      : options_(std::move(options)), heading_(&heading) {}
  void check(const Expected<void>& done);
  bool is_in_pause(const dds::RawSample& sample) const;
  bool is_left_out(const Source& source, const dds::RawSample& sample) const;
  Expected<RecordingFile> open(const std::filesystem::path& path);
  void open_next(Time now);
  /// Of a transient local topic.
  void remember(KeptSample one);
  Expected<void> write_remembered(RecordingFile& file, Time now);

  RecorderOptions options_;
  const Heading* heading_;
  std::optional<RecordingFile> file_;
  std::filesystem::path path_;
  std::deque<std::filesystem::path> files_;
  int splits_ = 0, snapshots_ = 0;
  Time opened_{}, flushed_{}, looked_at_disk_{};
  Time pause_begin_ = Time::max(), pause_end_ = Time::max();  // of the last pause
  std::uint64_t messages_ = 0, written_ = 0;
  std::map<std::string, std::uint64_t> lost_, lost_written_;
  /// What a late reader would be given: it belongs to the head of every file.
  std::map<InstanceKey, std::deque<KeptSample>> remembered_;
  std::deque<KeptSample> ring_;
  std::uint64_t ring_bytes_ = 0;
  std::optional<Error> error_;
};

}  // namespace prehend::recorder
