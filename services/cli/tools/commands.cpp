#include "services/cli/tools/commands.hpp"

#include <fmt/format.h>

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

namespace prehend::cli {
namespace {

struct Command {
  std::string_view name;
  int (*run)(const std::vector<std::string>&);
  std::string_view help;
};
constexpr Command commands[] = {
    {"demo", play, "play a demonstration through all services and judge the grasp"},
    {"status", status_command, "who is there and how they fare"},
    {"alive", alive_command, "does a service on this host answer for itself"},
    {"metrics", metrics_command, "serve what services say of themselves to Prometheus"},
    {"stop", stop_command, "stop the robots of a rig, or of all, until they are released"},
    {"release", release_command, "end a stop"},
    {"consent", consent_command, "hold the deadman of a robot hand"},
    {"audit", audit_command, "who led, stopped and released robot hands"},
    {"takeover", takeover_command, "say whose commands a robot hand obeys"},
    {"discovery-server", server_command, "by which services find each other without multicast"},
    {"doctor", doctor_command, "what is wrong with this machine's set-up, and the mend"},
    {"keys", keys_command, "keys with which processes know each other"},
    {"scene", scene_command, "draw a scene from a seed"},
};

}  // namespace

std::string help() {
  std::string text =
      "prehend: turns a human hand into a robot hand\n\n"
      "Usage: prehend COMMAND [ARGUMENTS]; prehend COMMAND --help tells more\n\n";
  for (const Command& command : commands)
    text += fmt::format("  {:<17}{}\n", command.name, command.help);
  for (const Tool& tool : tools()) text += fmt::format("  {:<17}{}\n", tool.name, tool.help);
  return text + "\nExit codes: 0 done, 1 the answer is no, 2 wrong use, 3 environment broken.\n";
}

int run(const std::vector<std::string>& arguments) {
  const std::string& name = arguments.front();
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  for (const Command& command : commands)
    if (command.name == name) return command.run(rest);
  for (const Tool& tool : tools())
    if (tool.name == name) return become(tool, rest);
  return complain({"unknown command '" + name + "'", "prehend", "see --help"}, exit_wrong_use);
}

}  // namespace prehend::cli
