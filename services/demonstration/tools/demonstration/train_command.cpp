// `prehend demonstration train`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "services/demonstration/files/recogniser_file.hpp"
#include "services/demonstration/tools/demonstration/commands.hpp"
#include "services/demonstration/tools/demonstration/takes_argument.hpp"
#include "services/demonstration/tools/evaluation/trial.hpp"

namespace prehend::demonstration {
namespace {

struct TrainArguments {
  std::string folder, model;
  TrainerOptions options;
  bool json = false;
};

std::size_t people_of(const std::vector<const Take*>& takes) {
  std::set<std::string> people;
  for (const Take* take : takes) people.insert(take->user);
  return people.size();
}

Expected<std::vector<TaskRecogniser>> train_all(const Takes& takes, const TrainerOptions& options) {
  const auto tasks = by_task(takes.takes);
  Progress progress("training");
  std::vector<TaskRecogniser> made;
  std::size_t done = 0;
  std::optional<Error> trouble;
  for (const auto& [task, own] : tasks) {
    const auto tell = [&](double share) {
      progress.show(done + static_cast<std::size_t>(100 * share), 100 * tasks.size());
    };
    auto recognisers = train_recognisers(own, {methods.begin(), methods.end()}, options, tell);
    done += 100;
    if (!recognisers) {  // the other tasks are learnt all the same
      if (trouble) log::warning(*trouble);
      trouble = Error{recognisers.error().what, "task " + task, recognisers.error().hint};
      continue;
    }
    for (Recogniser& recogniser : *recognisers) {
      auto objects = ObjectLikelihood::learn(own, recogniser.classes());
      made.push_back({task, std::move(recogniser), static_cast<unsigned>(people_of(own)),
                      static_cast<unsigned>(own.size()),
                      objects ? std::optional(std::move(*objects)) : std::nullopt});
    }
  }
  if (made.empty() && trouble) return tl::unexpected(*trouble);
  if (trouble) log::warning(*trouble);
  return made;
}

int train(const TrainArguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  const auto takes = told_takes(arguments.folder);
  if (!takes) return tool::complain(takes.error());
  const auto made = train_all(*takes, arguments.options);
  if (!made) return tool::complain(made.error());
  if (const auto saved = save_recognisers(arguments.model, *made); !saved)
    return tool::complain(saved.error());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (arguments.json) {
    nlohmann::ordered_json tasks;
    for (const TaskRecogniser& one : *made) {
      tasks[one.task]["classes"] = one.recogniser.classes();
      tasks[one.task]["people"] = one.people;
      tasks[one.task]["takes"] = one.takes;
      tasks[one.task]["objects"] = one.objects.has_value();
    }
    std::cout << nlohmann::ordered_json{{"tasks", tasks},
                                        {"rows", takes->rows},
                                        {"rows_left_out", takes->bad_rows},
                                        {"files_left_out", takes->bad_files},
                                        {"seconds", took.count()}}
              << "\n";
    return exit_done;
  }
  for (const TaskRecogniser& one : *made)
    if (one.recogniser.method() == methods.front())
      to_terminal("task {}: {} from {} takes of {} people\n", one.task,
                  fmt::join(one.recogniser.classes(), ", "), one.takes, one.people);
  to_terminal("{:.1f} s: {}\n", took.count(), arguments.model);
  return exit_done;
}

}  // namespace

void add_train(tool::Program& program) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = program.app().add_subcommand(
      "train", "Learns to recognise grasps from a folder with files task*.csv, a row a sample.");
  command->add_option("folder", arguments->folder, "holds task*.csv")->required();
  command->add_option("--model", arguments->model, "file to write")->required();
  command->add_option("--seed", arguments->options.seed, "of first weights")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return train(*arguments); });
}

}  // namespace prehend::demonstration
