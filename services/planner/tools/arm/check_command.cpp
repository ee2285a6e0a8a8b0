// `prehend arm check`: what is missing or suspicious in a URDF, or in an arm of the lab.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/arm/inverse.hpp"
#include "common/base/to_terminal.hpp"
#include "common/model/arm_choice.hpp"
#include "services/planner/tools/arm/commands.hpp"
#include "services/planner/tools/arm_import/make_arm.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "services/planner/tools/hand_import/finding_report.hpp"
#include "services/planner/tools/hand_import/robot_file.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::string what, tip;
  bool json = false;
  RobotFileOptions options;
};

void describe(const model::ArmModel& arm, Json& document) {
  document["name"] = arm.name;
  document["joints"] = Json::array();
  for (const model::ArmJoint& joint : arm.joints)
    document["joints"].push_back({{"name", joint.name},
                                  {"lower_rad", joint.lower},
                                  {"upper_rad", joint.upper},
                                  {"velocity_rad_s", joint.velocity},
                                  {"torque_n_m", joint.max_torque}});
  document["reach_m"] = arm::reach_bound(arm);
  document["closed_form"] = arm::puma_form(arm).has_value();
}

void judge_urdf(const CheckArguments& arguments, std::vector<UrdfFinding>& findings,
                Json& document) {
  const auto robot = read_robot_file(arguments.what, arguments.options);
  if (!robot) {
    findings.push_back(unreadable(robot.error()));
    return;
  }
  const MeshReader meshes = mesh_files(arguments.what, arguments.options.packages);
  findings = check_arm(*robot, meshes, arguments.tip);
  if (!is_usable(findings)) return;
  const auto made =
      make_arm(*robot, robot->name.empty() ? "arm" : robot->name, meshes, arguments.tip);
  if (made)
    describe(made->model, document);
  else
    findings.insert(findings.begin(), {Severity::error, "no-arm", "robot " + robot->name, 0,
                                       made.error().message(), "see the line"});
}

int run_check(const CheckArguments& arguments) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(arguments.what, ignored);
  std::vector<UrdfFinding> findings;
  Json document{{"file", arguments.what}, {"usable", false}};
  if (is_file) {
    judge_urdf(arguments, findings, document);
  } else {
    const auto arm = model::load_arm(arguments.what);
    if (!arm && arm.error().exit == exit_wrong_use) return tool::complain(arm.error());
    if (arm)
      describe(*arm, document);
    else
      findings.push_back({Severity::error, "no-arm", arguments.what, 0, arm.error().message(),
                          "correct the file"});
  }
  const bool usable = is_usable(findings);
  document["usable"] = usable;
  document["findings"] = Json::array();
  for (const UrdfFinding& finding : findings) document["findings"].push_back(to_json(finding));
  if (arguments.json) {
    std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
  } else {
    for (const UrdfFinding& finding : findings) print(finding);
    to_terminal("{}: {}, {} finding{}\n", arguments.what, usable ? "usable" : "not usable",
                findings.size(), findings.size() == 1 ? "" : "s");
    if (usable)
      to_terminal("{} joints, reaches {:.2f} m from its shoulder, inverse kinematics {}\n",
                  document["joints"].size(), document["reach_m"].get<double>(),
                  document["closed_form"].get<bool>() ? "in closed form" : "by search");
  }
  return usable ? exit_done : exit_no;
}

}  // namespace

void add_check(tool::Program& program) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.app().add_subcommand(
      "check",
      "Lists what is missing or suspicious in a URDF that shall be an arm, each with its mend, or\n"
      "loads an arm of the lab. Exit code 0: usable, perhaps with warnings, 1: not usable, 2: "
      "wrong use.");
  command->add_option("ARM", arguments->what, "a URDF, xacro or MJCF, or an arm's name or folder")
      ->required();
  command->add_option("--tip", arguments->tip, "the link at the arm's end");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  add_file_options(*command, arguments->options);
  program.on(*command, [arguments] { return run_check(*arguments); });
}

}  // namespace prehend::planner
