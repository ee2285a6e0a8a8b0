#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/service/shell.hpp"
#include "services/recorder/core/topic_filter.hpp"
#include "services/recorder/service/hand_easing.hpp"
#include "services/recorder/service/operator_link.hpp"
#include "services/recorder/service/player.hpp"

namespace prehend::recorder {

/// Opens a recording to be played. What processes said of themselves then is left out, as it is not
/// so now: beacons would tell the services wrong clocks, and a status services that are not there.
/// Nor is consent of then consent now.
Expected<Tape> open_tape(const std::vector<std::filesystem::path>& files,
                         const TopicFilter& topics);

/// A player at work: orders in, topics out. It ends its shell when the tape is at its end.
class PlayerService {
 public:
  struct Options {
    std::optional<Time> start_at;      // none: after the delay
    Duration delay{};                  // for readers to find the player's writers
    std::optional<HandEasing> easing;  // moves a hand to its place first
    /// Called a hundred times a second, for who watches: keys, a line of progress.
    std::function<void()> on_tick = [] {};
  };

  /// Makes the writers; plays as soon as the shell runs. The shell must outlive it.
  static Expected<std::unique_ptr<PlayerService>> create(service::Shell& shell, Tape tape,
                                                         PlayerOptions player, Options options);

  /// stop, and what the player obeys. Returns what to answer.
  Expected<std::string> execute(const std::string& order);
  Player::Stats stats() const { return player_->stats(); }
  /// False as long as it waits for its start, or for a hand.
  bool plays() const { return thread_.joinable(); }
  /// What of the tape could not be read.
  std::size_t damage() const { return player_->tape().damage().size(); }

  /// Plays no more; after the shell has ended.
  void finish() { thread_ = {}; }

 private:
  PlayerService(service::Shell& shell, Options options);
  Expected<void> join(Tape tape, PlayerOptions player);
  void begin();
  void tick(Time now);
  bool ease(Time now);

  service::Shell& shell_;
  Options options_;
  recording::types::Library types_;
  std::optional<dds::Participant> participant_;
  std::unique_ptr<Player> player_;
  std::optional<OperatorLink> operator_;
  Time start_{};
  std::uint64_t counted_ = 0;  // as the status knows
  std::jthread thread_;        // last: it uses the rest
};

}  // namespace prehend::recorder
