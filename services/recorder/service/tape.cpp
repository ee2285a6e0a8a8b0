#include "services/recorder/service/tape.hpp"

#include <algorithm>

#include "common/recording/layout/latched_samples.hpp"
#include "common/recording/layout/older_types.hpp"

namespace prehend::recorder {

namespace {

Played played(const recording::Stream& stream, const recording::mcap::Message& message,
              bool older) {
  Played result;
  result.stream = &stream;
  result.log_time = from_ns(static_cast<std::int64_t>(message.log_time));
  dds::RawSample& sample = result.sample;
  sample.kind = stream.kind;
  if (stream.kind == dds::RawSample::Kind::data)
    sample.payload.assign(message.data.begin(), message.data.end());
  if (older) recording::make_current(sample.payload);
  sample.instance = stream.instance;
  sample.writer = stream.writer;
  sample.sequence = message.sequence;
  sample.sent = from_ns(static_cast<std::int64_t>(message.publish_time));
  sample.received = result.log_time;
  return result;
}

}  // namespace

Expected<Tape> Tape::open(const std::vector<std::filesystem::path>& files, const Wanted& wanted) {
  Tape tape;
  bool any = false;
  for (const auto& path : files) {
    auto reader = recording::mcap::Reader::open(path);
    if (!reader) return tl::unexpected(reader.error());
    auto file = std::make_unique<File>(File{std::move(*reader), {}, {}, {}, {}});
    for (const Error& error : file->reader.contents().damage) tape.note(error);
    for (const Error& remark : file->reader.contents().remarks) tape.remarks_.push_back(remark);
    for (const Error& remark : file->reader.measured().remarks) tape.remarks_.push_back(remark);
    const recording::mcap::Statistics& statistics = file->reader.statistics();
    const auto& contents = file->reader.contents();
    for (const auto& [id, channel] : contents.channels) {
      const auto schema = contents.schemas.find(channel.schema_id);
      auto stream = recording::to_stream(
          channel, schema == contents.schemas.end() ? "" : schema->second.name);
      if (!stream) {
        tape.note(stream.error());
        continue;
      }
      if (!wanted(stream->topic.name)) continue;
      const std::string current(recording::current_type(stream->topic.type));
      const bool older = current != stream->topic.type;
      stream->topic.type = current;
      const auto added = file->streams.emplace(id, std::move(*stream)).first;
      if (older) file->older.insert(&added->second);
    }
    tape.files_.push_back(std::move(file));  // the statistics stay where they are
    if (statistics.message_count == 0) continue;
    const Time first = from_ns(static_cast<std::int64_t>(statistics.message_start_time));
    const Time last = from_ns(static_cast<std::int64_t>(statistics.message_end_time));
    tape.start_ = any ? std::min(tape.start_, first) : first;
    tape.end_ = any ? std::max(tape.end_, last) : last;
    any = true;
  }
  tape.recording_start_ = tape.start_;
  tape.seek(tape.start_);
  std::optional<Time> first;
  for (const auto& file : tape.files_)
    if (file->waiting) first = std::min(first.value_or(tape.end_), file->waiting->log_time);
  if (!first)
    return fail("holds no message of these topics", files.empty() ? "" : files.front().string(),
                "see prehend recording info");
  tape.start_ = *first;
  return tape;
}

void Tape::note(const Error& error) {
  if (damage_.size() < 100) damage_.push_back(error);
}

std::vector<const recording::Stream*> Tape::streams() const {
  std::vector<const recording::Stream*> all;
  for (const auto& file : files_)
    for (const auto& [id, stream] : file->streams) all.push_back(&stream);
  return all;
}

void Tape::advance(File& file) {
  file.waiting.reset();
  while (file.cursor) {
    const auto message = file.cursor->next();
    if (!message) {
      note(message.error());
      continue;
    }
    if (!*message) return;
    const auto stream = file.streams.find((*message)->message.channel_id);
    if (stream == file.streams.end()) continue;
    file.waiting =
        played(stream->second, (*message)->message, file.older.contains(&stream->second));
    return;
  }
}

void Tape::seek(Time time) {
  for (auto& file : files_) {
    recording::mcap::Selection selection;
    selection.start = static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_ns(time)));
    selection.wanted = [raw = file.get()](const recording::mcap::Channel& channel) {
      return raw->streams.contains(channel.id);
    };
    file->cursor.emplace(file->reader.messages(selection));
    advance(*file);
  }
}

std::optional<Played> Tape::next() {
  File* earliest = nullptr;
  for (const auto& file : files_)
    if (file->waiting && (!earliest || file->waiting->log_time < earliest->waiting->log_time))
      earliest = file.get();
  if (!earliest) return std::nullopt;
  std::optional<Played> result = std::move(earliest->waiting);
  advance(*earliest);
  return result;
}

std::vector<Played> Tape::standing(Time time) {
  recording::LatchedSamples standing;
  for (const auto& file : files_) {
    recording::mcap::Selection selection;
    selection.end = static_cast<std::uint64_t>(std::max<std::int64_t>(1, to_ns(time))) - 1;
    selection.wanted = [raw = file.get()](const recording::mcap::Channel& channel) {
      const auto stream = raw->streams.find(channel.id);
      return stream != raw->streams.end() && stream->second.topic.qos.transient_local;
    };
    auto cursor = file->reader.messages(selection);
    while (true) {
      const auto message = cursor.next();
      if (!message) continue;
      if (!*message) break;
      const auto found = file->streams.find((*message)->message.channel_id);
      if (found == file->streams.end()) continue;
      standing.take(found->second, (*message)->message);
    }
  }
  const auto is_older = [this](const recording::Stream* stream) {
    return std::ranges::any_of(files_,
                               [&](const auto& file) { return file->older.contains(stream); });
  };
  std::vector<Played> all;
  for (const auto& sample : standing.samples())
    all.push_back(played(*sample.stream, sample.message(), is_older(sample.stream)));
  return all;
}

}  // namespace prehend::recorder
