// `prehend hand check`: what is missing or suspicious in a robot's file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "common/base/log.hpp"
#include "common/base/to_terminal.hpp"
#include "services/planner/tools/hand/commands.hpp"
#include "services/planner/tools/hand_import/finding_report.hpp"
#include "services/planner/tools/hand_import/make_hand.hpp"
#include "services/planner/tools/hand_import/palms.hpp"
#include "services/planner/tools/hand_import/robot_file.hpp"

namespace prehend::planner {
namespace {

struct CheckArguments {
  std::string file, palm;
  bool json = false;
  RobotFileOptions options;
};

int run_check(const CheckArguments& arguments) {
  const std::string& file = arguments.file;
  if (std::error_code ignored; !std::filesystem::is_regular_file(file, ignored)) {
    log::error("{}: there is no such file", file);
    return 2;
  }
  std::vector<UrdfFinding> findings;
  auto robot = read_robot_file(file, arguments.options);
  if (robot) {
    *robot = hand_of(std::move(*robot), arguments.palm);
    const MeshReader meshes = mesh_files(file, arguments.options.packages);
    findings = check(*robot, meshes);
    // What only shows when a hand is made of it: too many DoFs, no fingers.
    if (is_usable(findings))
      if (const auto hand = make_hand(*robot, robot->name.empty() ? "hand" : robot->name, meshes);
          !hand)
        findings.insert(findings.begin(), {Severity::error, "no-hand", "robot " + robot->name, 0,
                                           hand.error().message(), hand.error().hint});
  } else {
    findings.push_back(unreadable(robot.error()));
  }
  const bool usable = is_usable(findings);
  if (arguments.json) {
    nlohmann::ordered_json document{{"file", file}, {"usable", usable}};
    document["findings"] = nlohmann::ordered_json::array();
    for (const UrdfFinding& finding : findings) document["findings"].push_back(to_json(finding));
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    for (const UrdfFinding& finding : findings) print(finding);
    to_terminal("{}: {}, {} finding{}\n", file, usable ? "usable" : "not usable", findings.size(),
                findings.size() == 1 ? "" : "s");
  }
  return usable ? 0 : 1;
}

}  // namespace

void add_check(tool::Program& program) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.app().add_subcommand(
      "check",
      "Lists what is missing or suspicious in a file that shall be a hand, each with its "
      "mend.\n"
      "Exit code 0: usable, perhaps with warnings, 1: not usable, 2: wrong use.");
  command->add_option("FILE", arguments->file, "a URDF, xacro or MJCF")->required();
  command->add_option("--palm", arguments->palm,
                      "the link where the hand begins, of a robot with several or with an arm");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  add_file_options(*command, arguments->options);
  program.on(*command, [arguments] { return run_check(*arguments); });
}

}  // namespace prehend::planner
