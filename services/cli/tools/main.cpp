#include <fmt/format.h>

#include <iostream>

#include "common/tool/program.hpp"
#include "services/cli/tools/alive_command.hpp"
#include "services/cli/tools/arguments.hpp"
#include "services/cli/tools/audit/audit_command.hpp"
#include "services/cli/tools/demo/scene_command.hpp"
#include "services/cli/tools/dispatch.hpp"
#include "services/cli/tools/doctor/doctor_command.hpp"
#include "services/cli/tools/keys/keys_command.hpp"
#include "services/cli/tools/metrics/metrics_command.hpp"
#include "services/cli/tools/orders/consent_command.hpp"
#include "services/cli/tools/orders/release_command.hpp"
#include "services/cli/tools/orders/stop_command.hpp"
#include "services/cli/tools/orders/takeover_command.hpp"
#include "services/cli/tools/plays.hpp"
#include "services/cli/tools/server_command.hpp"
#include "services/cli/tools/status/status_command.hpp"

using namespace prehend;

namespace {

struct Command {
  std::string_view name;
  int (*run)(const std::vector<std::string>&);
  std::string_view help;
};
constexpr Command commands[] = {
    {"demo", cli::play, "play a demonstration through all services and judge the grasp"},
    {"status", cli::status_command, "who is there and how they fare"},
    {"alive", cli::alive_command, "does a service on this host answer for itself"},
    {"metrics", cli::metrics_command, "serve what services say of themselves to Prometheus"},
    {"stop", cli::stop_command, "stop the robots of a rig, or of all, until they are released"},
    {"release", cli::release_command, "end a stop"},
    {"consent", cli::consent_command, "hold the deadman of a robot hand"},
    {"audit", cli::audit_command, "who led, stopped and released robot hands"},
    {"takeover", cli::takeover_command, "say whose commands a robot hand obeys"},
    {"discovery-server", cli::server_command,
     "by which services find each other without multicast"},
    {"doctor", cli::doctor_command, "what is wrong with this machine's set-up, and the mend"},
    {"keys", cli::keys_command, "keys with which processes know each other"},
    {"scene", cli::scene_command, "draw a scene from a seed"},
};

std::string help() {
  std::string text =
      "prehend: turns a human hand into a robot hand\n\n"
      "Usage: prehend COMMAND [ARGUMENTS]; prehend COMMAND --help tells more\n\n";
  for (const Command& command : commands)
    text += fmt::format("  {:<17}{}\n", command.name, command.help);
  for (const cli::Tool& tool : cli::tools())
    text += fmt::format("  {:<17}{}\n", tool.name, tool.help);
  return text + "\nExit codes: 0 done, 1 the answer is no, 2 wrong use, 3 environment broken.\n";
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  tool::choose_log(arguments);
  if (arguments.empty() || arguments.front() == "--help" || arguments.front() == "-h") {
    (arguments.empty() ? std::cerr : std::cout) << help();
    return arguments.empty() ? exit_wrong_use : exit_done;
  }
  if (arguments.front() == "--version") {
    std::cout << "prehend " PREHEND_VERSION "\n";
    return exit_done;
  }
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  for (const Command& command : commands)
    if (command.name == arguments.front()) return command.run(rest);
  for (const cli::Tool& tool : cli::tools())
    if (tool.name == arguments.front()) return cli::become(tool, rest);
  return cli::complain({"unknown command '" + arguments.front() + "'", "prehend", "see --help"},
                       exit_wrong_use);
}
