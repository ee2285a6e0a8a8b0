#include "services/recorder/service/player.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "common/base/log.hpp"
#include "common/recording/types/stamps.hpp"

namespace prehend::recorder {
namespace {

constexpr std::size_t max_lateness = 1'000'000;
constexpr double slowest = 1e-3, fastest = 1e3;
// Who starts later than this does not hurry to catch up.
constexpr Duration latest_start = std::chrono::milliseconds(100);
// A stamp further away, in played time, is none of this recording.
constexpr double max_s = 1e9;

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace

Expected<std::unique_ptr<Player>> Player::create(Tape tape, dds::Participant& participant,
                                                 const recording::types::Library& types,
                                                 PlayerOptions options) {
  std::unique_ptr<Player> made(new Player(std::move(tape), types, std::move(options)));
  if (made->from_ > made->to_)
    return fail("the range is empty", "replay", "the recording ends before it begins");
  for (const recording::Stream* stream : made->tape_.streams()) {
    const auto key = std::pair(stream->topic.name, stream->writer);
    if (made->writers_.contains(key)) continue;
    dds::RawTopic topic = stream->topic;
    // Readers of today match it; a recording may be older than a key.
    if (const recording::types::Structure* type = types.find(topic.type))
      topic.keyed = std::ranges::any_of(type->fields, &recording::types::Field::key);
    if (const auto other = made->options_.remap.find(topic.name);
        other != made->options_.remap.end())
      topic.name = other->second;
    // So may be its ownership, which both ends must have alike.
    if (const dds::TopicInfo* contract = dds::find_topic(topic.name))
      topic.qos.exclusive_ownership = contract->qos.exclusive_ownership;
    const dds::TopicQos recorded = topic.qos;
    for (const auto& [pattern, text] : made->options_.qos) {
      if (::fnmatch(pattern.c_str(), stream->topic.name.c_str(), 0) != 0) continue;
      const auto qos = recording::qos_of(text, recorded);
      if (!qos) return tl::unexpected(qos.error());
      topic.qos = *qos;
    }
    auto writer = dds::RawWriter::create(participant, topic);
    if (!writer) return tl::unexpected(writer.error());
    made->writers_.emplace(key, std::move(*writer));
  }
  // Before any order comes, which may move it.
  made->go_to(made->from_);
  return made;
}

Player::Player(Tape tape, const recording::types::Library& types, PlayerOptions options)
    : tape_(std::move(tape)),
      types_(types),
      options_(std::move(options)),
      from_(options_.from.value_or(tape_.start())),
      to_(std::min(options_.to.value_or(tape_.end()), tape_.end())),
      transport_(from_) {
  transport_.set_rate(clock(), options_.rate);
}

Time Player::clock() {
  return Time(std::chrono::duration_cast<Duration>(Clock::now().time_since_epoch()));
}

void Player::fetch() {
  next_ = tape_.next();
  if (next_ && next_->log_time > to_) next_.reset();
}

void Player::go_to(Time position) {
  position = std::clamp(position, from_, to_);
  transport_.seek(clock(), position);
  to_system_ = system_now().time_since_epoch() - clock().time_since_epoch();
  if (position > tape_.start())
    for (Played& played : tape_.standing(position)) {
      played = by_now(std::move(played));
      count(write(*played.stream, played.sample));
    }
  tape_.seek(position);
  fetch();
}

bool Player::write(const recording::Stream& stream, const dds::RawSample& sample) {
  const auto writer = writers_.find({stream.topic.name, stream.writer});
  return writer != writers_.end() && writer->second.write(sample, sample.sent);
}

Played Player::by_now(Played played) const {
  if (!options_.stamps_now) return played;
  const auto now = [&](Time recorded) { return moved(recorded, played.log_time); };
  played.sample.sent = now(played.sample.sent);
  if (const recording::types::Structure* type = types_.find(played.stream->topic.type))
    recording::types::move_stamps(
        *type, [&](std::int64_t stamp) { return to_ns(now(from_ns(stamp))); },
        played.sample.payload);
  return played;
}

void Player::count(bool written) {
  ++(written ? stats_.published : stats_.refused);
}

void Player::publish_next(std::unique_lock<std::mutex>& lock) {
  const Played played = by_now(*std::exchange(next_, std::nullopt));
  fetch();
  // What is written comes to readers in this process before write() returns, and they may wait for
  // somebody who waits for the lock.
  lock.unlock();
  const bool written = write(*played.stream, played.sample);
  lock.lock();
  count(written);
}

Time Player::moved(Time recorded, Time log_time) const {
  const double away = 1e-9 * (static_cast<double>(to_ns(recorded)) -  //
                              static_cast<double>(to_ns(log_time)));
  if (std::abs(away) > max_s * std::min(1.0, transport_.rate())) return recorded;
  return transport_.when(recorded) + to_system_;
}

void Player::play(const std::stop_token& stop, Time start) {
  ::prctl(PR_SET_TIMERSLACK, 1000);  // ns; the usual 50 µs would show in every message
  std::unique_lock lock(mutex_);
  to_system_ = system_now().time_since_epoch() - clock().time_since_epoch();
  Time begin = start - to_system_;
  news_.wait_until(lock, stop, Clock::now() + (begin - clock()), [] { return false; });
  // Not when this thread woke up: several players keep together.
  if (clock() > begin + latest_start) begin = clock();
  transport_.seek(begin, transport_.position(begin));
  begun_ = true;
  if (!options_.paused) transport_.run(begin);
  while (!stop.stop_requested()) {
    if (!next_ && transport_.runs()) {
      if (!options_.loop) break;
      ++stats_.rounds;
      go_to(from_);
      continue;
    }
    if (burst_ > 0 && next_) {
      --burst_;
      transport_.seek(clock(), next_->log_time);
      publish_next(lock);
      continue;
    }
    burst_ = 0;
    if (!transport_.runs()) {
      const std::uint64_t orders = orders_;
      news_.wait(lock, stop, [&] { return orders_ != orders; });
      continue;
    }
    const Time due = transport_.when(next_->log_time), now = clock();
    if (due > now) {
      const std::uint64_t orders = orders_;
      news_.wait_until(lock, stop, Clock::now() + (due - now), [&] { return orders_ != orders; });
      if (clock() < due) continue;  // an order came
    }
    if (lateness_us_.size() < max_lateness)
      lateness_us_.push_back(static_cast<float>(1e6 * to_seconds(clock() - due)));
    publish_next(lock);
  }
  stats_.ended = true;
  lock.unlock();
  // Reliable readers get the last samples too.
  for (auto& [key, writer] : writers_) writer.raw().wait_for_acknowledgments({2, 0});
}

Expected<std::string> Player::execute(const std::string& order) {
  std::istringstream words(order);
  std::string verb, rest;
  double number = 0;
  words >> verb;
  const bool has_number = static_cast<bool>(words >> number) && std::isfinite(number);
  if (!has_number) {
    words.clear();
    words >> rest;
  }
  const std::scoped_lock lock(mutex_);
  const auto answer = [&]() -> Expected<std::string> {
    if (verb == "start" || verb == "resume") {
      options_.paused = false;
      if (begun_ && !transport_.runs()) transport_.run(clock());
      return "playing";
    }
    if (verb == "pause") {
      options_.paused = true;
      if (transport_.runs()) transport_.pause(clock());
      return "paused";
    }
    if (verb == "step" || (verb == "burst" && has_number && number >= 1)) {
      options_.paused = true;
      if (transport_.runs()) transport_.pause(clock());
      burst_ = verb == "step" ? 1 : static_cast<std::uint64_t>(std::min(number, 1e12));
      return verb == "step" ? "stepped" : fmt::format("burst of {}", burst_);
    }
    if (verb == "seek" && has_number) {
      go_to(from_ + seconds(std::clamp(number, 0.0, 1e9)));
      return fmt::format("at {:.3f} s", to_seconds(transport_.position(clock()) - from_));
    }
    if (verb == "rate" && number >= slowest && number <= fastest) {
      transport_.set_rate(clock(), number);
      return fmt::format("rate {}", number);
    }
    if (verb == "loop" && (rest == "on" || rest == "off")) {
      options_.loop = rest == "on";
      return order;
    }
    if (verb == "state") return state();
    return fail("unknown order '" + order + "'", "replayer",
                "start, pause, resume, step, burst N, seek S, rate R, loop on|off, state or stop");
  }();
  ++orders_;
  news_.notify_all();
  return answer;
}

std::string Player::state() const {
  return fmt::format("{} at {:.3f} of {:.3f} s, rate {}, {} messages played",
                     options_.paused ? "paused" : "playing",
                     to_seconds(std::min(transport_.position(clock()), to_) - from_),
                     to_seconds(to_ - from_), transport_.rate(), stats_.published);
}

Player::Stats Player::stats() {
  const std::scoped_lock lock(mutex_);
  Stats now = stats_;
  now.runs = !options_.paused;
  now.loops = options_.loop;
  now.rate = transport_.rate();
  now.position = to_seconds(std::min(transport_.position(clock()), to_) - from_);
  now.length = to_seconds(to_ - from_);
  if (!lateness_us_.empty() && now.ended) {
    std::sort(lateness_us_.begin(), lateness_us_.end());
    const auto quantile = [&](double q) {
      return static_cast<double>(
          lateness_us_[static_cast<std::size_t>(q * static_cast<double>(lateness_us_.size() - 1))]);
    };
    now.late_p50_us = quantile(0.5);
    now.late_p99_us = quantile(0.99);
    now.late_max_us = quantile(1);
  }
  return now;
}

}  // namespace prehend::recorder
