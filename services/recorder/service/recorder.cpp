#include "services/recorder/service/recorder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <numeric>

namespace prehend::recorder {

using SampleKind = dds::RawSample::Kind;

namespace {

constexpr std::size_t max_remembered = 1000;  // of an instance that keeps all

std::filesystem::path with_suffix(const std::filesystem::path& file, const std::string& suffix) {
  return file.parent_path() / (file.stem().string() + suffix + file.extension().string());
}

}  // namespace

Expected<Recorder> Recorder::create(RecorderOptions options, const Heading& heading, Time now) {
  Recorder recorder(std::move(options), heading);
  if (recorder.options_.snapshot.count() == 0) {
    recorder.open_next(now);
    if (recorder.error_) return tl::unexpected(*recorder.error_);
  }
  return recorder;
}

void Recorder::check(const Expected<void>& done) {
  if (!done && !error_) error_ = done.error();
}

Expected<RecordingFile> Recorder::open(const std::filesystem::path& path) {
  if (std::error_code ignored; std::filesystem::exists(path, ignored))
    return fail("is there already", path.string(), "choose another name or remove it");
  return RecordingFile::create(path, *heading_, options_.compression);
}

void Recorder::open_next(Time now) {
  path_ = splits_ == 0 ? options_.file : with_suffix(options_.file, fmt::format("_{}", splits_));
  ++splits_;
  auto file = open(path_);
  if (!file) return check(tl::unexpected(file.error()));
  file_.emplace(std::move(*file));
  opened_ = now;
  lost_written_.clear();
  files_.push_back(path_);
  check(write_remembered(*file_, now));
  if (options_.keep_files > 0 && files_.size() > static_cast<std::size_t>(options_.keep_files)) {
    std::error_code ignored;
    std::filesystem::remove(files_.front(), ignored);
    files_.pop_front();
  }
}

void Recorder::remember(KeptSample one) {
  const InstanceKey key{one.source, one.sample->writer, one.sample->instance};
  if (one.sample->kind != SampleKind::data) {
    remembered_.erase(key);
    return;
  }
  auto& kept = remembered_[key];
  const int depth = one.source->topic.qos.writer_depth;
  kept.push_back(std::move(one));
  while (kept.size() > (depth > 0 ? static_cast<std::size_t>(depth) : max_remembered))
    kept.pop_front();
}

Expected<void> Recorder::write_remembered(RecordingFile& file, Time now) {
  for (const auto& [key, kept] : remembered_)
    for (const KeptSample& one : kept)
      if (const auto done = file.write(*one.source, *one.sample, now); !done) return done;
  return {};
}

void Recorder::take(const Source& source, dds::RawSample&& sample) {
  if (error_) return;
  lost_.try_emplace(source.topic.name, 0);
  if (options_.snapshot.count() > 0) {
    // What a late reader would be given belongs to a snapshot also when it came in a pause.
    if (is_left_out(source, sample) && !source.topic.qos.transient_local) return;
    const Time newest = sample.received;
    ring_.push_back({&source, std::make_shared<const dds::RawSample>(std::move(sample))});
    ring_bytes_ += ring_.back().size();
    while (!ring_.empty() && (ring_.front().sample->received + options_.snapshot < newest ||
                              ring_bytes_ > options_.snapshot_bytes)) {
      ring_bytes_ -= ring_.front().size();
      // What leaves the ring is what a late reader at its beginning would have been given.
      if (ring_.front().source->topic.qos.transient_local) remember(std::move(ring_.front()));
      ring_.pop_front();
    }
    return;
  }
  if (source.topic.qos.transient_local)
    remember({&source, std::make_shared<const dds::RawSample>(sample)});
  if (is_left_out(source, sample)) return;
  if (messages_ == 0) opened_ = sample.received;  // no part is left empty behind
  if (file_->size() >= options_.split_bytes || file_->is_full() ||
      sample.received - opened_ >= options_.split_time) {
    check(close());
    if (!error_) open_next(sample.received);
    if (error_) return;
    // It is remembered, and was written with the rest.
    if (source.topic.qos.transient_local && sample.kind == SampleKind::data) {
      ++messages_;
      return;
    }
  }
  // Not before what resume() has written.
  check(file_->write(source, sample, is_in_pause(sample) ? pause_end_ : sample.received));
  if (!error_) ++messages_;
}

void Recorder::tick(Time now) {
  if (error_ || !file_) return;
  if (now - looked_at_disk_ >= std::chrono::seconds(1)) {
    looked_at_disk_ = now;
    if (lost_ != lost_written_) {
      check(file_->write_losses(lost_));
      lost_written_ = lost_;
    }
    if (const auto room = check_space(path_, 0, options_.keep_free); !room) {
      check(close());
      if (!error_) {
        error_ = room.error();
        error_->what += "; the recording has ended";
      }
      return;
    }
  }
  // More often would make small chunks, which compress badly, and a long index.
  if (now - flushed_ < std::chrono::milliseconds(500)) return;
  flushed_ = now;
  check(file_->flush());
}

void Recorder::pause(Time now) {
  if (paused()) return;
  pause_begin_ = now;
  pause_end_ = Time::max();
}

void Recorder::resume(Time now) {
  if (!paused()) return;
  pause_end_ = now;
  if (file_ && !error_) check(write_remembered(*file_, now));
}

bool Recorder::is_in_pause(const dds::RawSample& sample) const {
  return sample.received >= pause_begin_ && sample.received < pause_end_;
}

bool Recorder::is_left_out(const Source& source, const dds::RawSample& sample) const {
  if (!is_in_pause(sample)) return false;
  // resume() has written what a late reader would be given; this one was still on its way then.
  return paused() || !source.topic.qos.transient_local;
}

Expected<Snapshot> Recorder::snapshot(Time now) {
  if (options_.snapshot.count() == 0)
    return fail("is not kept", "snapshot", "start the recorder with --snapshot SECONDS");
  const std::string suffix =
      fmt::format("_{:%Y%m%dT%H%M%S}_{}", std::chrono::time_point_cast<std::chrono::seconds>(now),
                  ++snapshots_);
  Snapshot taken{.path = with_suffix(options_.file, suffix),
                 .heading = heading_,
                 .compression = options_.compression,
                 .keep_free = options_.keep_free,
                 .start = ring_.empty() ? now : ring_.front().sample->received,
                 .head = {},
                 .ring = ring_,
                 .lost = lost_};
  for (const auto& [key, kept] : remembered_)
    taken.head.insert(taken.head.end(), kept.begin(), kept.end());
  return taken;
}

void Recorder::add(const Snapshot::Written& snapshot) {
  messages_ += snapshot.messages;
  written_ += snapshot.bytes;
  path_ = snapshot.path;
  files_.push_back(snapshot.path);
}

Expected<void> Recorder::close() {
  if (!file_) return error_ ? Expected<void>(tl::unexpected(*error_)) : Expected<void>();
  if (!error_) check(file_->write_losses(lost_));
  if (!error_) check(file_->close());
  written_ += file_->size();
  file_.reset();
  if (error_) return tl::unexpected(*error_);
  return {};
}

std::uint64_t Recorder::lost() const {
  return std::accumulate(lost_.begin(), lost_.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& entry) { return sum + entry.second; });
}

}  // namespace prehend::recorder
