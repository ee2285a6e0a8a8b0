// `prehend tasks list` and `prehend tasks check`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/base/to_terminal.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/performer/tools/tasks/commands.hpp"

namespace prehend::performer {
namespace {

using Json = nlohmann::ordered_json;

struct ListArguments {
  std::string folder = (state_directory() / "tasks").string();
  bool json = false;
};

struct CheckArguments {
  std::vector<std::string> files;
  bool json = false;
};

Expected<std::vector<std::filesystem::path>> files_of(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  std::filesystem::directory_iterator entry(folder, error), end;
  while (!error && entry != end) {
    if (entry->path().extension() == ".task") files.push_back(entry->path());
    entry.increment(error);
  }
  if (error) return fail(error.message(), folder.string(), "is the path right?");
  std::sort(files.begin(), files.end());
  return files;
}

int list(const ListArguments& arguments) {
  const auto files = files_of(arguments.folder);
  if (!files) return tool::complain(files.error());
  Json document{{"tasks", Json::array()}};
  std::size_t bad = 0;
  for (const auto& file : *files) {
    const auto task = tasks::load_task(file);
    if (!task) {
      log::warning(task.error());
      ++bad;
      continue;
    }
    if (!arguments.json)
      to_terminal("{:24} {:3} steps, {} demonstrations  {}\n", task->name, task->steps.size(),
                  task->demonstrations, file.string());
    document["tasks"].push_back({{"name", task->name},
                                 {"file", file.string()},
                                 {"steps", task->steps.size()},
                                 {"demonstrations", task->demonstrations}});
  }
  if (arguments.json) std::cout << document << "\n";
  return bad == 0 ? exit_done : exit_no;
}

int check_files(const CheckArguments& arguments) {
  Json document{{"files", Json::array()}};
  bool all = true;
  for (const std::string& file : arguments.files) {
    const auto task = tasks::load_task(file);
    all &= task.has_value();
    Json entry{{"file", file}, {"ok", task.has_value()}, {"reason", nullptr}};
    if (!task) {
      entry["reason"] = task.error().what;
      log::error(task.error());
    } else if (!arguments.json) {
      to_terminal("{}: {} in {} steps\n", file, task->name, task->steps.size());
    }
    document["files"].push_back(std::move(entry));
  }
  if (arguments.json) std::cout << document << "\n";
  return all ? exit_done : exit_no;
}

}  // namespace

void add_list(tool::Program& program) {
  auto arguments = std::make_shared<ListArguments>();
  CLI::App* command = program.app().add_subcommand(
      "list", "The tasks in a folder. Exit code 1: one of its files is no task.");
  command->add_option("folder", arguments->folder, "holds NAME.task")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return list(*arguments); });
}

void add_check(tool::Program& program) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.app().add_subcommand(
      "check", "Are these files sound tasks? Exit code 1: one is not.");
  command->add_option("files", arguments->files, "NAME.task")->required();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return check_files(*arguments); });
}

}  // namespace prehend::performer
