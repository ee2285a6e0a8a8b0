// `prehend tasks show` and `prehend tasks edit`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/to_terminal.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/performer/tools/tasks/commands.hpp"

namespace prehend::performer {
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
  const auto task = tasks::load_task(arguments.file);
  if (!task) return tool::complain(task.error());
  if (!arguments.json) {
    to_terminal("{}", to_toml(*task));
    return exit_done;
  }
  Json document{
      {"name", task->name}, {"demonstrations", task->demonstrations}, {"steps", Json::array()}};
  for (const tasks::Step& step : task->steps)
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

struct EditArguments {
  std::string file, from;
};

/// What was shown stays in the file, but the next demonstration is learnt from with it anew.
int edit(const EditArguments& arguments) {
  auto record = tasks::load_record(arguments.file);
  if (!record) return tool::complain(record.error());
  const auto text = read_file(arguments.from);
  if (!text) return tool::complain(text.error());
  auto task = tasks::from_toml(*text, arguments.from);
  if (!task) return tool::complain(task.error(), exit_no);
  record->task = std::move(*task);
  const auto saved = tasks::save_record(arguments.file, *record);
  return saved ? exit_done : tool::complain(saved.error());
}

}  // namespace

void add_edit(tool::Program& program) {
  auto arguments = std::make_shared<EditArguments>();
  CLI::App* command = program.app().add_subcommand(
      "edit", "Takes a task as somebody has changed what `show` says. Exit code 1: it is no task.");
  command->add_option("file", arguments->file, "NAME.task")->required();
  command->add_option("--from", arguments->from, "the changed TOML")->required();
  program.on(*command, [arguments] { return edit(*arguments); });
}

void add_show(tool::Program& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      program.app().add_subcommand("show", "A task as TOML: what is put where, and how.");
  command->add_option("file", arguments->file, "NAME.task")->required();
  command->add_flag("--json", arguments->json, "one JSON document; steps count from 0");
  program.on(*command, [arguments] { return show(*arguments); });
}

}  // namespace prehend::performer
