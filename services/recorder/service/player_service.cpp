#include "services/recorder/service/player_service.hpp"

#include "common/base/log.hpp"
#include "common/recording/types/idl.hpp"
#include "common/service/membership.hpp"

namespace prehend::recorder {
namespace {

constexpr Duration period = std::chrono::milliseconds(10);
constexpr Duration patience = std::chrono::seconds(5);  // until the hand says where it is

/// A start is said in the system's time, as several players have it.
Time soon(Duration delay) {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()) + delay;
}

}  // namespace

Expected<Tape> open_tape(const std::vector<std::filesystem::path>& files,
                         const TopicFilter& topics) {
  return Tape::open(files, [&](const std::string& topic) {
    const dds::TopicInfo* known = dds::find_topic(topic);
    return !(known && known->content == dds::Content::process) &&
           topic != dds::operator_consent.name && topics.wants(topic);
  });
}

Expected<std::unique_ptr<PlayerService>> PlayerService::create(service::Shell& shell, Tape tape,
                                                               PlayerOptions player,
                                                               Options options) {
  std::unique_ptr<PlayerService> made(new PlayerService(shell, std::move(options)));
  if (const auto joined = made->join(std::move(tape), std::move(player)); !joined)
    return tl::unexpected(joined.error());
  made->begin();
  return made;
}

PlayerService::PlayerService(service::Shell& shell, Options options)
    : shell_(shell), options_(std::move(options)) {}

Expected<void> PlayerService::join(Tape tape, PlayerOptions options) {
  auto types = recording::types::load_contract();
  if (!types) return tl::unexpected(types.error());
  types_ = std::move(*types);
  auto participant =
      dds::Participant::create(service::membership(shell_.config(), "player", "replayer"));
  if (!participant) return tl::unexpected(participant.error());
  participant_.emplace(std::move(*participant));
  auto player = Player::create(std::move(tape), *participant_, types_, std::move(options));
  if (!player) {
    player.error().exit = exit_wrong_use;  // topics and QoS are what was asked for
    return tl::unexpected(player.error());
  }
  player_ = std::move(*player);
  return {};
}

void PlayerService::begin() {
  // Readers have the delay from now on, since the writers are there.
  start_ = options_.start_at.value_or(soon(options_.delay));
  operator_.emplace(
      shell_, "replayer", [this](const std::string& order) { return execute(order); },
      participant_->identity());
  if (options_.easing)
    shell_.subscribe(
        dds::robot_state, [this](const v1::HandState& state, const dds::SampleInfo& info) {
          if (options_.easing && !info.gone && state.hand().to_string() == options_.easing->hand())
            options_.easing->on_state(state, shell_.now());
        });
  shell_.on_tick(period, [this](Time now) { tick(now); });
  shell_.status().running();
}

Expected<std::string> PlayerService::execute(const std::string& order) {
  if (order == "stop") {
    shell_.stop();
    return "stopped";
  }
  return player_->execute(order);
}

void PlayerService::tick(Time now) {
  options_.on_tick();
  if (options_.easing && !ease(now)) return;
  if (!thread_.joinable()) {
    if (now < start_ - std::chrono::milliseconds(20)) return;
    // The last stretch is waited for more exactly than ticks come.
    thread_ = std::jthread([this, start = start_](const std::stop_token& stop) {
      player_->play(stop, start);
      shell_.stop();
    });
  }
  const std::uint64_t published = player_->stats().published;
  shell_.status().count("messages", published - counted_);
  counted_ = published;
}

// True when the hand is in its place.
bool PlayerService::ease(Time now) {
  HandEasing& easing = *options_.easing;
  if (!easing.begun()) {
    if (now - start_ > patience) {
      log::error("nobody says robot/state of {}; nothing was played", easing.hand());
      shell_.stop(exit_broken);
    }
    return false;
  }
  player_->write(easing.stream(), easing.command(now));
  if (!easing.has_arrived(now)) return false;
  options_.easing.reset();
  start_ = now;
  return true;
}

}  // namespace prehend::recorder
