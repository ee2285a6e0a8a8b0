#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "common/dds/raw.hpp"
#include "common/recording/types/type.hpp"
#include "services/recorder/core/transport.hpp"
#include "services/recorder/service/tape.hpp"

namespace prehend::recorder {

struct PlayerOptions {
  std::optional<Time> from, to;  // range of log time; none: all
  bool loop = false;             // from the end it goes on at the beginning
  double rate = 1;               // so many times as fast as recorded
  bool paused = false;           // at first
  /// Time stamps, inside and beside the messages, are moved as log time is: each to when the tape
  /// is there. So stamps that were equal stay equal, as long as it is not paused, sought or given
  /// another rate in between.
  bool stamps_now = false;
  std::map<std::string, std::string> remap;  // topic: what it is called here
  /// Pattern of topics: what their writers offer otherwise than recorded, as in a recording
  /// («best_effort keep_last=1»); the last one that matches counts.
  std::vector<std::pair<std::string, std::string>> qos;
};

/// Plays a tape to topics, each recorded writer by a writer of its own with its QoS.
class Player {
 public:
  /// Makes the writers; `types` are those whose stamps can be moved. All arguments must outlive it.
  static Expected<std::unique_ptr<Player>> create(Tape tape, dds::Participant& participant,
                                                  const recording::types::Library& types,
                                                  PlayerOptions options);

  /// Plays from `start` on (at once when that is past) until the end of the range or until it is
  /// stopped; for a thread of its own.
  void play(const std::stop_token& stop, Time start);

  /// start, resume, pause, step, burst N, seek S (from the start), rate R, loop on|off, state. Safe
  /// from every thread.
  Expected<std::string> execute(const std::string& order);

  struct Stats {
    bool runs = false, loops = false, ended = false;
    double position = 0, length = 0, rate = 1;  // s, s
    std::uint64_t published = 0, refused = 0, rounds = 0;
    double late_p50_us = 0, late_p99_us = 0, late_max_us = 0;
  };
  Stats stats();

  Tape& tape() { return tape_; }  // before play()
  /// Writes a sample of the tape with another payload; before play().
  bool write(const recording::Stream& stream, const dds::RawSample& sample);

 private:
  using Clock = std::chrono::steady_clock;
  Player(Tape tape, const recording::types::Library& types, PlayerOptions options);
  static Time clock();
  void go_to(Time position);
  void fetch();
  /// With the stamps that it is played with.
  Played by_now(Played played) const;
  void publish_next(std::unique_lock<std::mutex>& lock);
  void count(bool written);
  Time moved(Time recorded, Time log_time) const;
  std::string state() const;

  Tape tape_;
  const recording::types::Library& types_;
  PlayerOptions options_;
  Time from_, to_;
  std::map<std::pair<std::string, dds::Guid>, dds::RawWriter> writers_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable_any news_;
  Transport transport_;
  bool begun_ = false;
  Duration to_system_{};  // from the clock of play() to that of the system
  std::optional<Played> next_;
  std::uint64_t burst_ = 0, orders_ = 0;
  Stats stats_;
  std::vector<float> lateness_us_;
};

}  // namespace prehend::recorder
