#include <CLI/CLI.hpp>
#include <memory>

#include "services/robot/tools/commands.hpp"
#include "services/robot/tools/visit.hpp"

namespace prehend::robot {

void add_check(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "check", "does the robot at robot.port answer, and how is it; nothing moves");
  const auto a = std::make_shared<VisitArguments>();
  a->lab.add_to(*command);
  command->add_flag("--json", a->json, "a JSON document");
  program.on(*command, [a] { return visit(*a, false); });
}

}  // namespace prehend::robot
