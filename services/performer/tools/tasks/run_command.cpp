// `prehend tasks run`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "common/service/arguments.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/performer/service/service.hpp"
#include "services/performer/tools/tasks/commands.hpp"
#include "services/performer/tools/tasks/news.hpp"

namespace prehend::performer {
namespace {

using Json = nlohmann::ordered_json;

struct RunArguments {
  service::LabArguments lab;
  std::string task;
  bool rehearse = false, json = false;
};

Json document_of(const tasks::TaskModel& task, const Performed& performed) {
  Json document{{"task", task.name},          {"done", performed.done},
                {"reason", performed.reason}, {"hand", performed.hand},
                {"moved", performed.moved},   {"seconds", performed.seconds},
                {"steps", Json::array()}};
  for (const Verdict& verdict : performed.verdicts)
    document["steps"].push_back({{"object", verdict.object},
                                 {"done", verdict.done},
                                 {"planned", verdict.planned},
                                 {"error_m", verdict.error},
                                 {"error_rad", verdict.turn},
                                 {"max_tilt_rad", verdict.max_tilt},
                                 {"reason", verdict.reason}});
  return document;
}

void print(const Performed& performed) {
  for (std::size_t i = 0; i < performed.verdicts.size(); ++i) {
    const Verdict& verdict = performed.verdicts[i];
    to_terminal("{:2} {:16} {:8} {:7} {:5.1f} mm {:5.1f}°  {}\n", i + 1, verdict.object,
                verdict.done ? "done" : "not done", verdict.planned ? "planned" : "own",
                1000 * verdict.error, verdict.turn * 57.29578, verdict.reason);
  }
}

/// Does one task, and ends with it.
Expected<Performed> perform(service::Shell& shell, const tasks::TaskModel& task,
                            const PerformingOptions& options) {
  auto performer = Performer::create(shell);
  if (!performer) return tl::unexpected(performer.error());
  Expected<Performed> came_of_it = fail("interrupted", task.name, {}, exit_no);
  const auto begun = (*performer)->begin(task, options, [&](const Expected<Performed>& performed) {
    came_of_it = performed;
    shell.stop();
  });
  if (!begun) return tl::unexpected(begun.error());
  if (const auto ended = shell.run(); !ended) return tl::unexpected(ended.error());
  return came_of_it;
}

int run(const RunArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto file = tasks::task_path(
      arguments.task, tasks::task_folder(config->path("demonstration.tasks").string()));
  if (!file) return service::complain(file.error());
  const auto task = tasks::load_task(*file);
  if (!task) return service::complain(task.error());
  auto shell = service::Shell::create(
      arguments.lab.for_service(),
      {.name = "performer", .description = "Does a task.", .role = {}, .restarts = false});
  if (!shell) return service::complain(shell.error());
  PerformingOptions options{.only_rehearse = arguments.rehearse};
  if (!arguments.json) options.tell = show_news;
  const auto performed = perform(**shell, *task, options);
  if (!arguments.json) end_news();
  if (!performed) return service::complain(performed.error());
  if (performed->moved) remember(*file, *performed);
  if (arguments.json)
    std::cout << document_of(*task, *performed)
                     .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  else
    print(*performed);
  return performed->done ? exit_done : exit_no;
}

}  // namespace

void add_run(tool::Program& program) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = program.app().add_subcommand(
      "run",
      "Does a task with the robot hand of the lab, from where things stand now. Exit code 1: it is "
      "not done as it\nwas shown; what stands in the way is said before anything moves.");
  arguments->lab.add_to(*command);
  command->add_option("task", arguments->task, "its name, or a file NAME.task")->required();
  command->add_flag("--rehearse", arguments->rehearse, "only in thought: nothing moves");
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return run(*arguments); });
}

}  // namespace prehend::performer
