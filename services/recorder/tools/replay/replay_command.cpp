#include "services/recorder/tools/replay/replay_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/finite_number.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/service/arguments.hpp"
#include "common/tool/keyboard.hpp"
#include "services/recorder/service/player_service.hpp"
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
  if (const auto s = finite_number(text); s && *s >= 0 && *s < 9e9) return Time(seconds(*s));
  return fail("is no time", "--start-at " + text, "for example 2026-01-31T12:00:00Z");
}

/// Keys and a line of progress for who sits before the player.
class PlayerTerminal {
 public:
  explicit PlayerTerminal(bool quiet) : progress_(quiet) {}

  void tick(PlayerService& service) {
    while (const auto key = keyboard_.key()) on_key(service, *key);
    if (!service.plays()) return;
    const Player::Stats stats = service.stats();
    progress_.show(fmt::format("{} {:.1f} of {:.1f} s  rate {:g}  {} messages",
                               stats.runs ? "playing" : "paused", stats.position, stats.length,
                               stats.rate, stats.published));
  }
  void clear() { progress_.clear(); }

 private:
  void say(PlayerService& service, const std::string& order) {
    const auto answer = service.execute(order);
    progress_.clear();
    log::info("{}", answer ? *answer : answer.error().message());
  }

  void on_key(PlayerService& service, int key) {
    const Player::Stats stats = service.stats();
    const auto order = [&](const std::string& words) { say(service, words); };
    if (key == ' ') order(stats.runs ? "pause" : "resume");
    if (key == 's') order("step");
    if (key == 'b') order("burst 10");
    if (key == 'q') order("stop");
    if (key == 'l') order(stats.loops ? "loop off" : "loop on");
    if (key == tool::Keyboard::up) order(fmt::format("rate {}", stats.rate * 1.25));
    if (key == tool::Keyboard::down) order(fmt::format("rate {}", stats.rate / 1.25));
    if (key == tool::Keyboard::right) order(fmt::format("seek {}", stats.position + 5));
    if (key == tool::Keyboard::left)
      order(fmt::format("seek {}", std::max(0.0, stats.position - 5)));
  }

  ProgressLine progress_;
  tool::Keyboard keyboard_;
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

Expected<std::unique_ptr<service::Shell>> join(const Arguments& arguments) {
  std::vector<std::string> texts = arguments.lab.for_service();
  if (!arguments.rig.empty()) texts.insert(texts.end(), {"--set", "lab.rig=" + arguments.rig});
  return service::Shell::create(std::move(texts), {"replayer", "Plays recordings.", {}, false});
}

nlohmann::ordered_json document(const PlayerService& service) {
  const Player::Stats stats = service.stats();
  return {{"published", stats.published},
          {"refused", stats.refused},
          {"loops", stats.rounds},
          {"damage", service.damage()},
          {"late_us",
           {{"p50", stats.late_p50_us}, {"p99", stats.late_p99_us}, {"max", stats.late_max_us}}}};
}

/// What is asked for with --ease-in; nothing without.
Expected<std::optional<HandEasing>> easing_of(const Arguments& arguments, Tape& tape,
                                              const PlayerOptions& options) {
  if (arguments.ease_in.empty()) return std::nullopt;
  if (options.from) tape.seek(*options.from);
  return HandEasing::create(tape, arguments.ease_in);
}

int replay(const Arguments& arguments) {
  std::optional<Time> start_at;
  if (!arguments.start_at.empty()) {
    const auto time = time_of(arguments.start_at);
    if (!time) return service::complain(time.error(), exit_wrong_use);
    start_at = *time;
  }
  auto tape = open_tape({arguments.files.begin(), arguments.files.end()}, arguments.topics);
  if (!tape) return service::complain(tape.error(), exit_broken);
  for (const Error& damage : tape->damage()) log::warning(damage);
  for (const Error& remark : tape->remarks()) log::warning(remark);
  warn_of_old_commands(*tape, arguments);
  const auto options = player_options(arguments, *tape);
  if (!options) return service::complain(options.error(), exit_wrong_use);
  auto easing = easing_of(arguments, *tape, *options);
  if (!easing) return service::complain(easing.error(), exit_broken);

  const auto shell = join(arguments);
  if (!shell) return service::complain(shell.error());
  PlayerTerminal terminal(arguments.quiet || arguments.json);
  std::unique_ptr<PlayerService> service;
  auto created = PlayerService::create(**shell, std::move(*tape), *options,
                                       {.start_at = start_at,
                                        .delay = seconds(arguments.delay),
                                        .easing = std::move(*easing),
                                        .on_tick = [&] { terminal.tick(*service); }});
  if (!created) return service::complain(created.error());
  service = std::move(*created);
  const auto ended = (*shell)->run();
  if (!ended) return service::complain(ended.error());
  service->finish();
  terminal.clear();
  const Player::Stats stats = service->stats();
  log::info("{} messages played{}", stats.published,
            stats.refused ? fmt::format(", {} could not be", stats.refused) : "");
  if (arguments.json) std::cout << document(*service).dump() << "\n";
  // What could not be read was not played.
  if (*ended == exit_done && service->damage() > 0)
    return service::complain({fmt::format("{} parts could not be read", service->damage()),
                              arguments.files.front(), "prehend recording verify FILE names them"},
                             exit_no);
  return *ended;
}

}  // namespace

int replay_command(const std::vector<std::string>& texts) {
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

}  // namespace prehend::recorder
