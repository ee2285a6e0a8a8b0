#include "services/console/service/film.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "common/dds/topics.hpp"
#include "common/recording/layout/older_types.hpp"

namespace prehend::console {
namespace {

/// Between the end and the next beginning, so that the last picture can be looked at.
constexpr Duration pause = std::chrono::seconds(2);
constexpr double min_speed = 0.05, max_speed = 20;
/// Of what counts message by message, as many as clients who come late are told.
constexpr std::size_t max_queued = 256;
/// Who slept longer has not missed the film.
constexpr Duration max_step = std::chrono::milliseconds(1100);

std::optional<std::size_t> place_of(std::string_view topic) {
  for (std::size_t i = 0; i < dds::topic_table.size(); ++i)
    if (dds::topic_table[i].name == topic) return i;
  return std::nullopt;
}

}  // namespace

Expected<std::unique_ptr<Film>> Film::open(const std::filesystem::path& file) {
  auto reader = recording::mcap::Reader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  std::unique_ptr<Film> made(new Film(std::move(*reader)));
  if (!made->next_)
    return fail("holds no message of a lab", file.string(), "see prehend recording info FILE");
  made->begin_ = made->time_ = made->next_time_;
  made->end_ = from_ns(static_cast<std::int64_t>(made->reader_.statistics().message_end_time));
  return made;
}

Film::Film(recording::mcap::Reader reader) : reader_(std::move(reader)) {
  const auto& contents = reader_.contents();
  for (const auto& [id, channel] : contents.channels) {
    const auto schema = contents.schemas.find(channel.schema_id);
    const auto stream =
        recording::to_stream(channel, schema == contents.schemas.end() ? "" : schema->second.name);
    const auto place = stream ? place_of(stream->topic.name) : std::nullopt;
    if (!place) continue;
    // A type that is not ours under a name that is would be misread.
    const std::string current(recording::current_type(stream->topic.type));
    if (current == dds::topic_table[*place].type_name())
      channels_.emplace(id, Channel{*place, *stream, current != stream->topic.type});
  }
  rewind();
}

void Film::rewind() {
  cursor_.emplace(reader_.messages({.wanted = [this](const recording::mcap::Channel& channel) {
    return channels_.contains(channel.id);
  }}));
  advance();
}

/// Messages that cannot be read are passed by.
bool Film::advance() {
  next_.reset();
  while (true) {
    const auto read = cursor_->next();
    if (!read) continue;
    if (!*read) return false;
    const auto& [channel, message] = **read;
    const auto& [place, stream, older] = channels_.at(channel->id);
    next_ = Letter{place, stream.instance, static_cast<std::int64_t>(message.publish_time), nullptr,
                   static_cast<std::int64_t>(message.log_time)};
    if (stream.kind == dds::RawSample::Kind::data) {
      std::vector<std::uint8_t> bytes(message.data.begin(), message.data.end());
      if (older) recording::make_current(bytes);
      next_->payload = std::make_shared<const std::string>(bytes.begin(), bytes.end());
    }
    next_time_ = from_ns(static_cast<std::int64_t>(message.log_time));
    return true;
  }
}

std::vector<Letter> Film::letters(Time now) {
  const Duration step = last_call_ ? std::min(now - *last_call_, max_step) : Duration::zero();
  last_call_ = now;
  if (ended_ && playing_ && now - *ended_ >= pause) seek_ = begin_;
  if (seek_) return jump(*std::exchange(seek_, std::nullopt));
  std::vector<Letter> all;
  if (!playing_ || ended_) return all;
  time_ += std::chrono::duration_cast<Duration>(step * speed_);
  while (next_ && next_time_ <= time_) {
    all.push_back(std::move(*next_));
    advance();
  }
  if (!next_) ended_ = now;
  return all;
}

/// What somebody who had watched until then would have seen last.
std::vector<Letter> Film::jump(Time to) {
  rewind();
  std::map<std::pair<std::size_t, dds::Guid>, Letter> newest;
  std::deque<Letter> queued;
  while (next_ && next_time_ <= to) {
    const std::pair key{next_->topic, next_->instance};
    if (dds::topic_table[next_->topic].qos.reader_depth == 0) {
      queued.push_back(std::move(*next_));
      if (queued.size() > max_queued) queued.pop_front();
    } else if (next_->payload) {
      newest.insert_or_assign(key, std::move(*next_));
    } else {
      newest.erase(key);
    }
    advance();
  }
  time_ = to;
  ended_ = next_ ? std::nullopt : last_call_;
  sought_ = true;
  std::vector<Letter> all;
  for (auto& [key, letter] : newest) all.push_back(std::move(letter));
  for (Letter& letter : queued) all.push_back(std::move(letter));
  return all;
}

void Film::obey(const PlaybackRequest& request) {
  asked_ = request.id;
  told_.reset();
  if (!request.play) return;
  playing_ = *request.play;
  speed_ = std::clamp(request.speed, min_speed, max_speed);
  if (request.seek_ns) seek_ = std::clamp(from_ns(*request.seek_ns), begin_, end_);
  // From the end it goes on from the beginning.
  if (playing_ && ended_ && !seek_) seek_ = begin_;
}

std::optional<PlaybackState> Film::news(Time now) {
  if (told_ && !sought_ && now - *told_ < std::chrono::seconds(1)) return std::nullopt;
  told_ = now;
  using Status = PlaybackState::Status;
  // Held at its end it is paused: else who sees it would believe that it begins anew.
  const Status status = !playing_ ? Status::paused : ended_ ? Status::ended : Status::playing;
  return PlaybackState{status, to_ns(time_), speed_, std::exchange(sought_, false),
                       std::exchange(asked_, "")};
}

}  // namespace prehend::console
