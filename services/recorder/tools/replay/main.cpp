#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/convert/convert.hpp"
#include "common/recording/types/idl.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"
#include "services/recorder/core/ease_in.hpp"
#include "services/recorder/core/topic_filter.hpp"
#include "services/recorder/service/operator_link.hpp"
#include "services/recorder/service/player.hpp"
#include "services/recorder/tools/terminal/progress_line.hpp"

namespace prehend::recorder {
namespace {

struct Arguments {
  service::LabArguments lab;
  std::vector<std::string> files, remap, qos;
  TopicFilter topics;
  std::string rig, start_at, stamps = "kept", ease_in;
  double rate = 1, from = 0, to = 0, delay = 1, origin = 0;
  bool loop = false, paused = false, json = false, quiet = false;

  void add_to(CLI::App& app) {
    lab.add_to(app);
    app.add_option("files", files, "the recording; the parts of a split one")->required();
    app.add_option("-t,--topics", topics.include, "topic or pattern to play; repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("-x,--exclude", topics.exclude, "topic or pattern to leave out; repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("--remap", remap, "FROM=TO: play a topic under another name; repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option(
           "--qos", qos,
           "TOPIC=QOS: offer another QoS than recorded, as 'hand/*=best_effort keep_last=1'; "
           "repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("--rig", rig, "the rig to play to, instead of lab.rig");
    app.add_option("--rate", rate, "times the original speed")->check(CLI::Range(1e-3, 1e3));
    app.add_option("--from", from, "s from the start of the recording")
        ->check(CLI::Range(0.0, 1e9));
    app.add_option("--to", to, "s from the start of the recording")->check(CLI::Range(1e-9, 1e9));
    app.add_flag("--loop", loop, "begin again at the end");
    app.add_flag("--paused", paused, "wait for the order to start");
    app.add_option("--stamps", stamps,
                   "kept: as recorded; now: moved so that what was recorded happens now")
        ->capture_default_str()
        ->check(CLI::IsMember({"kept", "now"}));
    app.add_option("--delay", delay, "s for readers to be found before it begins")
        ->check(CLI::Range(0.0, 3600.0));
    app.add_option(
        "--start-at", start_at,
        "begin at this time (s since 1970, or 2026-01-31T12:00:00Z), for several players");
    app.add_option("--origin", origin,
                   "recorded time (s since 1970) that is played at the start; for several players");
    app.add_option("--ease-in", ease_in,
                   "first move this robot hand from where it is to the first command");
    app.add_flag("--json", json, "at the end, one JSON document on standard output");
    app.add_flag("--quiet", quiet, "no progress");
  }
};

Expected<Time> time_of(const std::string& text) {
  std::tm parts{};
  if (const char* end = ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts); end && *end == '\0')
    return from_ns(static_cast<std::int64_t>(::timegm(&parts)) * 1'000'000'000);
  try {
    std::size_t used = 0;
    const double s = std::stod(text, &used);
    if (used == text.size() && s >= 0 && s < 9e9) return Time(seconds(s));
  } catch (const std::exception&) {
  }
  return fail("is no time", "--start-at " + text, "for example 2026-01-31T12:00:00Z");
}

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// Moves a robot hand to where a recording's first command has it, then lets the player begin.
class Easing {
 public:
  /// Finds the next command for the hand on the tape.
  static Expected<Easing> create(Tape& tape, const std::string& hand) {
    while (auto played = tape.next()) {
      if (played->stream->topic.name != dds::robot_command.name ||
          played->sample.kind != dds::RawSample::Kind::data)
        continue;
      v2::HandCommand command;
      if (!dds::decode(dds::robot_command, played->sample, command) ||
          command.hand().to_string() != hand)
        continue;
      const auto folder = model::named_hand(command.model().to_string());
      if (!folder) return tl::unexpected(folder.error());
      auto model = model::HandModel::load(*folder);
      if (!model) return tl::unexpected(model.error());
      const auto X_WB = convert::from_message(command.X_WB());
      if (!X_WB) return tl::unexpected(X_WB.error());
      const HandPlace to{convert::from_message(command.dof()), *X_WB};
      if (to.dof.size() != static_cast<Eigen::Index>(model->dofs().size()))
        return fail("the first command does not fit the hand", "--ease-in " + hand);
      return Easing(std::move(*played), command, std::move(*model), to);
    }
    return fail("the recording holds no robot/command for it", "--ease-in " + hand);
  }

  const std::string hand() const { return command_.hand().to_string(); }
  bool begun() const { return way_.has_value(); }
  /// The first state begins the way.
  void on_state(const v1::HandState& state, Time now) {
    const auto X_WB = convert::from_message(state.X_WB());
    const HandPlace from{convert::from_message(state.dof()), X_WB ? *X_WB : Pose::Identity()};
    if (way_ || !X_WB || from.dof.size() != to_.dof.size() || !from.dof.allFinite()) return;
    way_.emplace(model_, from, to_);
    began_ = now;
  }
  /// Commands the place for now; true at the end of the way.
  bool step(Player& player, Time now) {
    const Duration t = now - began_;
    const HandPlace place = way_->at(t);
    command_.stamp_ns(to_ns(now));
    command_.dof(convert::to_message(place.dof));
    command_.X_WB(convert::to_message(place.X_WB));
    dds::RawSample sample = first_.sample;
    sample.payload = dds::encode(dds::robot_command, command_);
    sample.sent = now;
    player.write(*first_.stream, sample);
    return t >= way_->duration();
  }

 private:
  Easing(Played first, const v2::HandCommand& command, model::HandModel model, HandPlace to)
      : first_(std::move(first)), command_(command), model_(std::move(model)), to_(std::move(to)) {
    // It moves the hand, and knows nothing of objects: whoever watches for a hand that stands still
    // must not take it for one.
    command_.mode(v1::MODE_DIRECT);
    command_.weight(0);
    command_.object("");
    command_.grasp_type(v1::GRASP_NONE);
    command_.extrapolating(false);
    command_.origin_ns(0);
  }
  Played first_;
  v2::HandCommand command_;
  model::HandModel model_;
  HandPlace to_;
  std::optional<EaseIn> way_;
  Time began_{};
};

/// A player at work: orders in, topics out.
class Replay {
 public:
  Replay(service::Shell& shell, Player& player, std::optional<Easing> easing, Time start,
         const dds::GuidPrefix& identity, const Arguments& arguments)
      : shell_(shell),
        player_(player),
        easing_(std::move(easing)),
        start_(start),
        progress_(arguments.quiet || arguments.json),
        operator_(
            shell, "replayer", [this](const std::string& order) { return execute(order); },
            identity) {
    if (easing_)
      shell.subscribe(dds::robot_state,
                      [this](const v1::HandState& state, const dds::SampleInfo& info) {
                        if (!info.gone && state.hand().to_string() == easing_->hand())
                          easing_->on_state(state, shell_.now());
                      });
    shell.on_tick(std::chrono::milliseconds(10), [this](Time now) { tick(now); });
    shell.status().running();
  }

  /// After the shell has ended.
  void finish() {
    thread_ = {};
    progress_.clear();
  }

 private:
  Expected<std::string> execute(const std::string& order) {
    if (order == "stop") {
      shell_.stop();
      return "stopped";
    }
    return player_.execute(order);
  }

  void say(const std::string& order) {
    const auto answer = execute(order);
    progress_.clear();
    log::info("{}", answer ? *answer : answer.error().message());
  }

  void on_key(int key) {
    const Player::Stats stats = player_.stats();
    if (key == ' ') say(stats.runs ? "pause" : "resume");
    if (key == 's') say("step");
    if (key == 'b') say("burst 10");
    if (key == 'q') say("stop");
    if (key == 'l') say(stats.loops ? "loop off" : "loop on");
    if (key == tool::Keyboard::up) say(fmt::format("rate {}", stats.rate * 1.25));
    if (key == tool::Keyboard::down) say(fmt::format("rate {}", stats.rate / 1.25));
    if (key == tool::Keyboard::right) say(fmt::format("seek {}", stats.position + 5));
    if (key == tool::Keyboard::left) say(fmt::format("seek {}", std::max(0.0, stats.position - 5)));
  }

  void tick(Time now) {
    while (const auto key = keyboard_.key()) on_key(*key);
    if (easing_ && !ease(now)) return;
    if (!thread_.joinable()) {
      if (now < start_ - std::chrono::milliseconds(20)) return;
      // The last stretch is waited for more exactly than ticks come.
      thread_ = std::jthread([this, start = start_](const std::stop_token& stop) {
        player_.play(stop, start);
        shell_.stop();
      });
    }
    const Player::Stats stats = player_.stats();
    shell_.status().count("messages", stats.published - counted_);
    counted_ = stats.published;
    progress_.show(fmt::format("{} {:.1f} of {:.1f} s  rate {:g}  {} messages",
                               stats.runs ? "playing" : "paused", stats.position, stats.length,
                               stats.rate, stats.published));
  }

  /// True when the hand is in its place.
  bool ease(Time now) {
    if (now < start_ && !easing_->begun()) return false;
    if (!easing_->begun()) {
      if (now - start_ > std::chrono::seconds(5)) {
        log::error("nobody says robot/state of {}; nothing was played", easing_->hand());
        shell_.stop(exit_broken);
      }
      return false;
    }
    if (!easing_->step(player_, now)) return false;
    easing_.reset();
    start_ = now;
    return true;
  }

  service::Shell& shell_;
  Player& player_;
  std::optional<Easing> easing_;
  Time start_;
  ProgressLine progress_;
  tool::Keyboard keyboard_;
  OperatorLink operator_;
  std::uint64_t counted_ = 0;
  std::jthread thread_;
};

/// What stands before the first «=» and what behind it; nothing when one of them is missing.
std::optional<std::pair<std::string, std::string>> split(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return std::nullopt;
  return std::pair(text.substr(0, equals), text.substr(equals + 1));
}

Expected<PlayerOptions> player_options(const Arguments& arguments, const Tape& tape) {
  PlayerOptions options;
  if (arguments.from > 0) options.from = tape.recording_start() + seconds(arguments.from);
  if (arguments.to > 0) options.to = tape.recording_start() + seconds(arguments.to);
  if (arguments.origin > 0) options.from = Time(seconds(arguments.origin));
  options.loop = arguments.loop;
  options.rate = arguments.rate;
  options.paused = arguments.paused;
  options.stamps_now = arguments.stamps == "now";
  for (const std::string& text : arguments.remap) {
    const auto parts = split(text);
    if (!parts) return fail("must be FROM=TO", "--remap " + text);
    options.remap.insert(*parts);
  }
  for (const std::string& text : arguments.qos) {
    const auto parts = split(text);
    if (!parts) return fail("must be TOPIC=QOS", "--qos " + text);
    if (const auto qos = recording::qos_of(parts->second); !qos) return tl::unexpected(qos.error());
    options.qos.push_back(*parts);
  }
  return options;
}

/// Robots refuse commands that are old; in lockstep time is that of the recording.
void warn_of_old_commands(const Tape& tape, const Arguments& arguments) {
  const auto moves_robots = [](const recording::Stream* stream) {
    return stream->topic.name == dds::robot_command.name;
  };
  if (arguments.stamps == "kept" && std::ranges::any_of(tape.streams(), moves_robots))
    log::warning("{} keeps its stamps: a robot refuses commands of then; --stamps now moves them",
                 dds::robot_command.name);
}

/// What processes said of themselves then is not so now: beacons would tell the services wrong
/// clocks, and a status services that are not there. Nor is consent of then consent now.
Expected<Tape> open_tape(const Arguments& arguments) {
  const auto wanted = [&](const std::string& topic) {
    const dds::TopicInfo* known = dds::find_topic(topic);
    return !(known && known->content == dds::Content::process) &&
           topic != dds::operator_consent.name && arguments.topics.wants(topic);
  };
  auto tape = Tape::open({arguments.files.begin(), arguments.files.end()}, wanted);
  if (!tape) return tape;
  for (const Error& damage : tape->damage()) log::warning(damage);
  warn_of_old_commands(*tape, arguments);
  return tape;
}

Expected<std::unique_ptr<service::Shell>> join(const Arguments& arguments) {
  std::vector<std::string> texts = arguments.lab.for_service();
  if (!arguments.rig.empty()) texts.insert(texts.end(), {"--set", "lab.rig=" + arguments.rig});
  return service::Shell::create(std::move(texts), {"replayer", "Plays recordings.", {}, false});
}

nlohmann::ordered_json document(Player& player) {
  const Player::Stats stats = player.stats();
  return {{"published", stats.published},
          {"refused", stats.refused},
          {"loops", stats.rounds},
          {"damage", player.tape().damage().size()},
          {"late_us",
           {{"p50", stats.late_p50_us}, {"p99", stats.late_p99_us}, {"max", stats.late_max_us}}}};
}

int replay(const Arguments& arguments) {
  std::optional<Time> start_at;
  if (!arguments.start_at.empty()) {
    const auto time = time_of(arguments.start_at);
    if (!time) return service::complain(time.error(), exit_wrong_use);
    start_at = *time;
  }
  auto tape = open_tape(arguments);
  if (!tape) return service::complain(tape.error(), exit_broken);
  const auto options = player_options(arguments, *tape);
  if (!options) return service::complain(options.error(), exit_wrong_use);
  std::optional<Easing> easing;
  if (!arguments.ease_in.empty()) {
    if (options->from) tape->seek(*options->from);
    auto made = Easing::create(*tape, arguments.ease_in);
    if (!made) return service::complain(made.error(), exit_broken);
    easing.emplace(std::move(*made));
  }

  const auto shell = join(arguments);
  if (!shell) return service::complain(shell.error());
  const auto types = recording::types::load_contract();
  if (!types) return service::complain(types.error(), exit_broken);
  auto participant =
      dds::Participant::create(service::membership((*shell)->config(), "player", "replayer"));
  if (!participant) return service::complain(participant.error(), exit_broken);
  auto player = Player::create(std::move(*tape), *participant, *types, *options);
  if (!player) return service::complain(player.error(), exit_wrong_use);

  const Time start = start_at.value_or(system_now() + seconds(arguments.delay));
  Replay work(**shell, **player, std::move(easing), start, participant->identity(), arguments);
  const auto ended = (*shell)->run();
  if (!ended) return service::complain(ended.error());
  work.finish();
  const Player::Stats stats = (*player)->stats();
  log::info("{} messages played{}", stats.published,
            stats.refused ? fmt::format(", {} could not be", stats.refused) : "");
  if (arguments.json) std::cout << document(**player).dump() << "\n";
  return *ended;
}

int run(const std::vector<std::string>& texts) {
  CLI::App app{
      "Plays recordings to topics: byte for byte, with keys and QoS as recorded.\n"
      "Keys: space pauses and resumes, s steps, b plays a burst of 10, left and right seek by 5 "
      "s,\n"
      "up and down change the rate, l loops, q stops. By topic: operator/command, target "
      "replayer,\n"
      "argument start, pause, resume, step, burst N, seek S, rate R, loop on|off, state or stop.",
      "prehend replay"};
  Arguments arguments;
  arguments.add_to(app);
  if (const auto code = service::parse(app, texts)) return *code;
  return replay(arguments);
}

}  // namespace
}  // namespace prehend::recorder

int main(int argc, char** argv) {
  return prehend::recorder::run({argv + 1, argv + argc});
}
