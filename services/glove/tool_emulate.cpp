#include <csignal>
#include <iostream>
#include <memory>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/glove_devices/device.hpp>

#include "options.hpp"
#include "recording.hpp"
#include "synthetic_hand.hpp"
#include "tool.hpp"

namespace prehend::glove {
namespace {

struct Arguments {
  std::string kind = "nest_of_birds";
  std::string from = "synthetic";
  std::string scene, link;
  std::string config = (share_directory() / "lab.toml").string();
  std::vector<std::string> overrides;
  double rate = 30;
  FaultOptions faults;
};

volatile std::sig_atomic_t stopped = 0;
extern "C" void on_signal(int) {
  stopped = 1;
}

Expected<DeviceOptions> make_options(const Arguments& arguments) {
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.scene.empty())
    overrides.push_back("lab.scene=" + std::filesystem::absolute(arguments.scene).string());
  const auto config = service::Config::load(arguments.config, overrides);
  if (!config) return tl::unexpected(config.error());
  return device_options(*config);
}

Expected<std::unique_ptr<FrameSource>> make_source(const Arguments& arguments,
                                                   const DeviceOptions& options) {
  constexpr std::string_view recording = "recording:";
  if (arguments.from == "synthetic") {
    auto hand = SyntheticHand::create(
        options.scene, options.catalogue,
        {.X_WT = options.X_WT, .rate = arguments.rate, .seed = arguments.faults.seed});
    if (!hand) return tl::unexpected(hand.error());
    return std::make_unique<SyntheticHand>(std::move(*hand));
  }
  if (arguments.from.starts_with(recording)) {
    auto made = Recording::load(arguments.from.substr(recording.size()),
                                {.X_WT = options.X_WT,
                                 .X_WH = options.scene.X_WH,
                                 .rate = options.scene.recording_rate,
                                 .hand_scale = options.hand_scale});
    if (!made) return tl::unexpected(made.error());
    return std::make_unique<Recording>(std::move(*made));
  }
  return fail("'" + arguments.from + "' is no source", "--from",
              "give synthetic or recording:FILE");
}

int run(const Arguments& arguments) {
  const auto kind = find_device(arguments.kind);
  if (!kind || !kind->emulate) {
    log::error("--kind: there is no emulator '{}'", arguments.kind);
    return 2;
  }
  if (!(arguments.rate >= 1 && arguments.rate <= 1000)) {
    log::error("--rate: must lie in 1 to 1000 Hz");
    return 2;
  }
  const auto options = make_options(arguments);
  if (!options) {
    log::error("{}", options.error().message());
    return 3;
  }
  const auto source = make_source(arguments, *options);
  if (!source) {
    log::error("{}", source.error().message());
    return 3;
  }
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  EmulationOptions emulation = emulation_of(*kind, *options, arguments.link);
  emulation.on_plugged = [](const std::string& where) { std::cout << where << std::endl; };
  emulation.rate = arguments.rate;
  emulation.faults = arguments.faults;
  const auto done = emulate(emulation, **source, [] { return stopped != 0; });
  if (done) return 0;
  log::error("{}", done.error().message());
  return 3;
}

}  // namespace

void add_emulate(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "emulate", "be a device that is not there; prints where it is plugged in, ends on SIGTERM");
  const auto a = std::make_shared<Arguments>();
  std::string kinds;
  for (const DeviceKind& kind : device_kinds())
    if (kind.emulate) kinds += (kinds.empty() ? "" : ", ") + std::string(kind.name);
  command->add_option("--kind", a->kind, kinds)->capture_default_str();
  command->add_option("--from", a->from, "synthetic or recording:FILE")->capture_default_str();
  command->add_option("--scene", a->scene, "scene file");
  command->add_option("--link", a->link, "path of a symbolic link to a serial port");
  command->add_option("--rate", a->rate, "Hz, measurements")->capture_default_str();
  command->add_option("--seed", a->faults.seed, "of noise and faults, beside the scene's own");
  command->add_option("--config", a->config, "the lab's configuration file")->capture_default_str();
  command->add_option("--set", a->overrides, "override: table.key=value (repeatable)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  FaultOptions& faults = a->faults;
  const auto share = CLI::Range(0.0, 1.0);
  command->add_option("--noise", faults.noise, "m, standard deviation of positions");
  command->add_option("--extreme", faults.extreme, "share of frames with an extreme point")
      ->check(share);
  command->add_option("--garbage", faults.garbage, "share of records after foreign bytes")
      ->check(share);
  command->add_option("--drop-bytes", faults.drop_bytes, "share of records that lose a byte")
      ->check(share);
  command->add_option("--swap-bytes", faults.swap_bytes, "share of records with bytes swapped")
      ->check(share);
  command->add_option("--silence", faults.silent_at, "s after the start, when it falls silent");
  command->add_option("--silence-for", faults.silent_for, "s that this lasts")
      ->capture_default_str();
  command->add_option("--unplug", faults.unplug_at, "s after the start, when it is pulled out");
  command->add_option("--unplug-for", faults.unplug_for, "s that this lasts")
      ->capture_default_str();
  command->callback([a, &exit_code] { exit_code = run(*a); });
}

}  // namespace prehend::glove
