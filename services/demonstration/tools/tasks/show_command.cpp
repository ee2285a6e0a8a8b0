// `prehend tasks show`.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "services/demonstration/files/task_file.hpp"
#include "services/demonstration/tools/tasks/commands.hpp"

namespace prehend::demonstration {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string file;
  bool json = false;
};

Json pose(const Pose& X) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::Quaterniond q(X.linear());
  return {{"position_m", {p.x(), p.y(), p.z()}},
          {"orientation_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

int show(const Arguments& arguments) {
  const auto task = load_task(arguments.file);
  if (!task) return tool::complain(task.error());
  if (!arguments.json) {
    fmt::print("{}", to_toml(*task));
    return exit_done;
  }
  Json document{
      {"name", task->name}, {"demonstrations", task->demonstrations}, {"steps", Json::array()}};
  for (const Step& step : task->steps)
    document["steps"].push_back({{"object", step.object},
                                 {"grasp", step.grasp},
                                 {"X_OG", pose(step.X_OG)},
                                 {"reference", step.reference},
                                 {"X_RO", pose(step.X_RO)},
                                 {"spread_m", step.spread},
                                 {"via_height_m", step.via_height},
                                 {"upright", step.upright},
                                 {"after", step.after}});
  std::cout << document << "\n";
  return exit_done;
}

}  // namespace

void add_show(tool::Program& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      program.app().add_subcommand("show", "A task as TOML: what is put where, and how.");
  command->add_option("file", arguments->file, "NAME.task")->required();
  command->add_flag("--json", arguments->json, "one JSON document; steps count from 0");
  program.on(*command, [arguments] { return show(*arguments); });
}

}  // namespace prehend::demonstration
