#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/serial/pseudo_terminal.hpp"
#include "common/service/arguments.hpp"
#include "common/tool/interrupt.hpp"
#include "services/robot/devices/emulation.hpp"
#include "services/robot/devices/nodes.hpp"
#include "services/robot/service/options.hpp"
#include "services/robot/tools/commands.hpp"
#include "services/robot/tools/twin.hpp"

namespace prehend::robot {
namespace {

struct EmulateArguments {
  service::LabArguments lab;
  std::string device = std::string(emulator_kinds().front().name);
  std::string hand, wiring, link, twin;
  int baud = -1;
  EmulatedOptions robot;
  FaultOptions faults;
  std::string stuck;
};

/// The DoF of that name.
Expected<std::size_t> dof_of(const model::HandModel& hand, const std::string& name) {
  std::string names;
  for (std::size_t d = 0; d < hand.dofs().size(); ++d) {
    if (hand.dofs()[d].name == name) return d;
    names += (names.empty() ? "" : ", ") + hand.dofs()[d].name;
  }
  return wrong_use("there is no joint '" + name + "'", "--stuck", "give one of " + names);
}

/// The hand that is emulated; which servo moves what of it goes to the arguments.
Expected<model::HandModel> hand_of(const EmulatorKind& kind, EmulateArguments& arguments) {
  if (!kind.hand.empty() && !arguments.hand.empty() && arguments.hand != kind.hand)
    return wrong_use("is not the hand of a " + arguments.device, "--hand " + arguments.hand,
                     "give " + std::string(kind.hand));
  if (kind.hand.empty() && arguments.hand.empty())
    return wrong_use("must be given: a " + arguments.device + " moves many hands", "--hand",
                     model::hand_hint());
  const std::filesystem::path folder =
      model::hand_directory(kind.hand.empty() ? arguments.hand : std::string(kind.hand));
  if (!kind.wiring.empty()) {
    const std::filesystem::path file =
        arguments.wiring.empty() ? folder / kind.wiring : std::filesystem::path(arguments.wiring);
    const auto text = read_file(file, "give --wiring; see services/robot/README.md");
    if (!text) return tl::unexpected(text.error());
    arguments.robot.wiring = *text;
    arguments.robot.wiring_file = file.string();
  }
  return model::HandModel::load(folder);
}

/// A pseudo-terminal, or topics of ROS 2.
Expected<std::function<Expected<std::unique_ptr<serial::Plug>>()>> way_to(
    const EmulatorKind& kind, const EmulateArguments& arguments) {
  if (kind.medium == Medium::topics) {
    if (!arguments.link.empty())
      return wrong_use("a " + arguments.device + " has no port", "--link",
                       "nodes of ROS 2 find it by its topics");
    const auto config = arguments.lab.load();
    if (!config) return tl::unexpected(config.error());
    const auto nodes = nodes_of(*config);
    if (!nodes) return tl::unexpected(nodes.error());
    return [nodes = *nodes] { return plug_into_nodes(nodes); };
  }
  return [link = arguments.link]() -> Expected<std::unique_ptr<serial::Plug>> {
    auto terminal = serial::PseudoTerminal::open(link);
    if (!terminal) return tl::unexpected(terminal.error());
    return std::make_unique<serial::PseudoTerminal>(std::move(*terminal));
  };
}

Expected<int> run(EmulateArguments arguments) {
  const auto kind = find_emulator(arguments.device);
  if (!kind) return tl::unexpected(kind.error());
  const auto hand = hand_of(**kind, arguments);
  if (!hand) return tl::unexpected(hand.error());
  if (!arguments.stuck.empty()) {
    const auto dof = dof_of(*hand, arguments.stuck);
    if (!dof) return tl::unexpected(dof.error());
    arguments.faults.stuck = *dof;
    if (arguments.faults.stuck_at < 0) arguments.faults.stuck_at = 0;
  }
  std::unique_ptr<Twin> twin;
  if (!arguments.twin.empty()) {
    const auto config = arguments.lab.load();
    if (!config) return tl::unexpected(config.error());
    auto joined = Twin::create(*config, *hand, config->text("robot.hand_name"), arguments.twin);
    if (!joined) return tl::unexpected(joined.error());
    twin = std::move(*joined);
  }
  tool::note_interrupts();
  EmulationOptions emulation;
  const auto plug_in = way_to(**kind, arguments);
  if (!plug_in) return tl::unexpected(plug_in.error());
  emulation.plug_in = *plug_in;
  emulation.baud = arguments.baud >= 0 ? arguments.baud : (*kind)->baud;
  emulation.faults = arguments.faults;
  emulation.on_plugged = [](const std::string& where) { std::cout << where << std::endl; };
  if (twin) emulation.on_step = [&twin](Emulator& robot) { twin->exchange(robot); };
  const auto robot = (*kind)->create(*hand, arguments.robot);
  if (!robot) return tl::unexpected(robot.error());
  const auto done = emulate(emulation, **robot, [] { return tool::interrupted(); });
  if (!done) return tl::unexpected(done.error());
  return exit_done;
}

void add_faults(CLI::App& command, FaultOptions& faults) {
  const auto share = CLI::Range(0.0, 1.0);
  command.add_option("--garbage", faults.line.garbage, "share of answers after foreign bytes")
      ->check(share);
  command.add_option("--drop-bytes", faults.line.drop_bytes, "share of answers that lose a byte")
      ->check(share);
  command.add_option("--swap-bytes", faults.line.swap_bytes, "share of answers with bytes swapped")
      ->check(share);
  command.add_option("--late", faults.late, "share of answers that come late")->check(share);
  command.add_option("--late-by", faults.late_by, "s")->capture_default_str();
  command.add_option("--silence", faults.silent_at, "s after the start, when it falls silent");
  command.add_option("--silence-for", faults.silent_for, "s that this lasts")
      ->capture_default_str();
  command.add_option("--cut", faults.cut_at, "s after the start, when the cable is pulled out");
  command.add_option("--cut-for", faults.cut_for, "s that this lasts")->capture_default_str();
  command.add_option("--hot", faults.hot_at, "s after the start, when it is too hot");
  command.add_option("--hot-for", faults.hot_for, "s that this lasts")->capture_default_str();
  command.add_option("--stuck-at", faults.stuck_at, "s after the start, when the joint is stuck");
  command.add_option("--stuck-for", faults.stuck_for, "s that this lasts")->capture_default_str();
  command.add_option("--restart", faults.restart_at,
                     "s after the start, when it is switched off and on");
  command.add_option("--seed", faults.seed, "of the faults");
}

}  // namespace

void add_emulate(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "emulate", "be a robot that is not there; prints its port, ends on SIGTERM");
  const auto a = std::make_shared<EmulateArguments>();
  a->lab.add_to(*command);
  command->add_option("--device", a->device, "which robot")->capture_default_str();
  command->add_option("--hand", a->hand, "the hand that it must be, or shall be");
  command->add_option("--wiring", a->wiring,
                      "file that says which servo moves what; else that of the hand");
  command->add_option("--link", a->link, "path of a symbolic link to its port");
  command->add_option("--baud", a->baud, "bits per second; 0: bytes take no time");
  command->add_option("--twin", a->twin, "name of a simulated hand whose joints its motors drive");
  command->add_flag("--homed", a->robot.initialized, "it was homed before");
  command->add_option("--temperature-bytes", a->robot.temperature_bytes, "of its feedback")
      ->check(CLI::Range(0, 2));
  command->add_option("--velocity-scale", a->robot.velocity_scale,
                      "how much faster it is than it is told");
  command->add_option("--id", a->robot.id, "on its line; 0: as it is sold")
      ->check(CLI::Range(0, 254));
  command->add_option("--answers-as", a->robot.answers_as, "id in its answers, as of another")
      ->check(CLI::Range(0, 254));
  command->add_option("--stuck", a->stuck, "joint that is stuck");
  add_faults(*command, a->faults);
  program.on(*command, [a]() -> int {
    const auto code = run(*a);
    return code ? *code : tool::complain(code.error());
  });
}

}  // namespace prehend::robot
