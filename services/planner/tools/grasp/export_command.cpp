// `prehend grasp export`: planned grasps as JSON or CSV.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/planning/export.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"

namespace prehend::planner {
namespace {

struct ExportArguments {
  std::string file, format = "json";
  Table table = Table::grasps;
  int index = -1;  // all
};

const std::map<std::string, Table> tables{{"grasps", Table::grasps},
                                          {"contacts", Table::contacts},
                                          {"wrenches", Table::wrenches},
                                          {"dof", Table::dof}};

int write(const ExportArguments& arguments) {
  auto plan = load_plan(arguments.file);
  if (!plan) {
    log::error(plan.error());
    return 2;
  }
  if (arguments.index >= static_cast<int>(plan->grasps.size())) {
    log::error("{} has {} grasps (count from 0)", arguments.file, plan->grasps.size());
    return 2;
  }
  if (arguments.format == "csv") {
    std::cout << to_csv(*plan, arguments.table);
    return 0;
  }
  nlohmann::ordered_json document;
  if (arguments.index >= 0) {
    document = to_json(*plan, plan->grasps[static_cast<std::size_t>(arguments.index)]);
  } else {
    document = summary_json(*plan);
    document["grasps"] = nlohmann::ordered_json::array();
    for (const auto& grasp : plan->grasps) document["grasps"].push_back(to_json(*plan, grasp));
  }
  std::cout << document.dump(2) << "\n";
  return 0;
}

}  // namespace

void add_export(tool::Program& program) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = program.app().add_subcommand(
      "export",
      "Planned grasps as JSON or CSV, on standard output. One grasp as JSON is also what\n"
      "`prehend grasp quality` reads. Exit code 0: done, 2: wrong use or file.");
  command->add_option("FILE", arguments->file, "that `prehend grasp plan --output` wrote")
      ->required();
  auto* index = command->add_option("--index", arguments->index, "only this grasp, from 0; JSON")
                    ->check(CLI::Range(0, 1'000'000));
  command->add_option("--format", arguments->format, "json or csv")
      ->capture_default_str()
      ->check(CLI::IsMember({"json", "csv"}));
  command->add_option("--table", arguments->table, "of the CSV: grasps, contacts, wrenches, dof")
      ->transform(CLI::CheckedTransformer(tables))
      ->excludes(index);
  program.on(*command, [arguments] { return write(*arguments); });
}

}  // namespace prehend::planner
