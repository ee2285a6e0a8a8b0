#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/tool/interrupt.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/service/options.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

/// The kinds that have this function.
template <class Function>
std::vector<std::string> names_of(Function DeviceKind::*function) {
  std::vector<std::string> names;
  for (const DeviceKind& kind : device_kinds())
    if (kind.*function) names.emplace_back(kind.name);
  return names;
}

struct EmulateArguments {
  std::string kind = names_of(&DeviceKind::emulate).front();
  std::string from = names_of(&DeviceKind::source).front();  // KIND[:FILE]
  std::string scene, link;
  std::string config = (share_directory() / "lab.toml").string();
  std::vector<std::string> overrides;
  double rate = 30;
  FaultOptions faults;
};

/// «synthetic or recording:FILE».
std::string sources() {
  std::string text;
  for (const DeviceKind& kind : device_kinds()) {
    if (!kind.source) continue;
    text += (text.empty() ? "" : " or ") + std::string(kind.name);
    if (kind.line == Line::file) text += ":FILE";
  }
  return text;
}

Expected<DeviceOptions> make_options(const EmulateArguments& arguments) {
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.scene.empty())
    overrides.push_back("lab.scene=" + std::filesystem::absolute(arguments.scene).string());
  const auto config = service::Config::load(arguments.config, overrides);
  if (!config) return tl::unexpected(config.error());
  return device_options(*config);
}

Expected<std::unique_ptr<FrameSource>> make_source(const EmulateArguments& arguments,
                                                   DeviceOptions options) {
  const std::size_t colon = arguments.from.find(':');
  const auto kind = find_device(arguments.from.substr(0, colon));
  const bool has_file = colon != std::string::npos;
  if (!kind || !kind->source || has_file != (kind->line == Line::file))
    return fail("'" + arguments.from + "' is no source", "--from", "give " + sources());
  options.rate = arguments.rate;
  options.seed = arguments.faults.seed;
  if (has_file) options.file = arguments.from.substr(colon + 1);
  return kind->source(options);
}

int run(const EmulateArguments& arguments) {
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
    log::error(options.error());
    return 3;
  }
  const auto source = make_source(arguments, *options);
  if (!source) {
    log::error(source.error());
    return 3;
  }
  tool::note_interrupts();
  EmulationOptions emulation = emulation_of(*kind, *options, arguments.link);
  emulation.on_plugged = [](const std::string& where) { std::cout << where << std::endl; };
  emulation.rate = arguments.rate;
  emulation.faults = arguments.faults;
  const auto done = emulate(emulation, **source, [] { return tool::interrupted(); });
  if (done) return 0;
  log::error(done.error());
  return 3;
}

}  // namespace

void add_emulate(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "emulate", "be a device that is not there; prints where it is plugged in, ends on SIGTERM");
  const auto a = std::make_shared<EmulateArguments>();
  command
      ->add_option("--kind", a->kind,
                   fmt::format("{}", fmt::join(names_of(&DeviceKind::emulate), ", ")))
      ->capture_default_str();
  command->add_option("--from", a->from, sources())->capture_default_str();
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
  program.on(*command, [a] { return run(*a); });
}

}  // namespace prehend::glove
