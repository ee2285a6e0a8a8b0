#include <csignal>
#include <iostream>
#include <memory>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/glove_devices/bird_emulator.hpp>
#include <prehend/glove_devices/pseudo_terminal.hpp>

#include "options.hpp"
#include "recording.hpp"
#include "synthetic_hand.hpp"
#include "tool.hpp"

namespace prehend::glove {
namespace {

struct Arguments {
  std::string from = "synthetic";
  std::string scene, link;
  std::string config = (share_directory() / "lab.toml").string();
  std::vector<std::string> overrides;
  double rate = 30;
  int sensors = 4;
  std::uint64_t seed = 0;
  bird::Faults faults;
  double silent_at = -1, silent_for = 2;  // s
};

volatile std::sig_atomic_t stopped = 0;
extern "C" void on_signal(int) {
  stopped = 1;
}

Expected<std::unique_ptr<FrameSource>> make_source(const Arguments& arguments) {
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.scene.empty())
    overrides.push_back("lab.scene=" + std::filesystem::absolute(arguments.scene).string());
  const auto config = service::Config::load(arguments.config, overrides);
  if (!config) return tl::unexpected(config.error());
  const auto options = device_options(*config);
  if (!options) return tl::unexpected(options.error());

  constexpr std::string_view recording = "recording:";
  if (arguments.from == "synthetic") {
    auto hand = SyntheticHand::create(
        options->scene, options->catalogue,
        {.X_WT = options->X_WT, .rate = arguments.rate, .seed = arguments.seed});
    if (!hand) return tl::unexpected(hand.error());
    return std::make_unique<SyntheticHand>(std::move(*hand));
  }
  if (arguments.from.starts_with(recording)) {
    auto made = Recording::load(arguments.from.substr(recording.size()),
                                {.X_WT = options->X_WT,
                                 .X_WH = options->scene.X_WH,
                                 .rate = options->scene.recording_rate,
                                 .hand_scale = options->hand_scale});
    if (!made) return tl::unexpected(made.error());
    return std::make_unique<Recording>(std::move(*made));
  }
  return fail("'" + arguments.from + "' is no source", "--from",
              "give synthetic or recording:FILE");
}

int emulate(const Arguments& arguments) {
  if (!(arguments.rate >= 1 && arguments.rate <= 1000)) {
    log::error("--rate: must lie in 1 to 1000 Hz");
    return 2;
  }
  const auto source = make_source(arguments);
  if (!source) {
    log::error("{}", source.error().message());
    return 3;
  }
  auto terminal = PseudoTerminal::open(arguments.link);
  if (!terminal) {
    log::error("{}", terminal.error().message());
    return 3;
  }
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::cout << (arguments.link.empty() ? terminal->path() : arguments.link) << std::endl;

  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration_cast<Duration>(Clock::now() - start); };
  const auto silent = [&](Duration now) {
    const double t = to_seconds(now) - arguments.silent_at;
    return arguments.silent_at >= 0 && t >= 0 && t < arguments.silent_for;
  };
  bird::Emulator tracker(arguments.sensors, arguments.faults);
  std::uint64_t tick = 0, n = 0;
  std::optional<Frame> current = (*source)->frame(0), next = (*source)->frame(1);
  while (stopped == 0) {
    const Duration due = seconds(static_cast<double>(tick) / arguments.rate);
    const std::string bytes = terminal->read(due - elapsed());
    const Duration now = elapsed();
    if (!bytes.empty() && !silent(now)) terminal->write(tracker.receive(bytes, now));
    if (now < due) continue;
    // What lies between the tracker's measurements is never seen; after the end the hand stays.
    while (next && next->stamp.time_since_epoch() <= due) {
      current = std::move(next);
      next = (*source)->frame(++n + 1);
    }
    const std::string records = tracker.measure(*current, now);
    if (!silent(now)) terminal->write(records);
    tick = std::max(tick + 1, static_cast<std::uint64_t>(to_seconds(now) * arguments.rate));
  }
  return 0;
}

}  // namespace

void add_emulate(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "emulate", "be a tracker on a pseudo-terminal; prints its path, ends on SIGTERM");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--from", a->from, "synthetic or recording:FILE")->capture_default_str();
  command->add_option("--scene", a->scene, "scene file");
  command->add_option("--link", a->link, "path of a symbolic link to the port");
  command->add_option("--rate", a->rate, "Hz, measurements")->capture_default_str();
  command->add_option("--sensors", a->sensors, "units")->check(CLI::Range(1, 6));
  command->add_option("--seed", a->seed, "of noise and faults, beside the scene's own");
  command->add_option("--config", a->config, "the lab's configuration file")->capture_default_str();
  command->add_option("--set", a->overrides, "override: table.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  const auto share = CLI::Range(0.0, 1.0);
  command->add_option("--garbage", a->faults.garbage, "share of records after foreign bytes")
      ->check(share);
  command->add_option("--drop-bytes", a->faults.drop_bytes, "share of records that lose a byte")
      ->check(share);
  command->add_option("--silence", a->silent_at, "s after the start, from when on it says nothing");
  command->add_option("--silence-for", a->silent_for, "s that this lasts")->capture_default_str();
  command->callback([a, &exit_code] {
    a->faults.seed = a->seed + 1;
    exit_code = emulate(*a);
  });
}

}  // namespace prehend::glove
