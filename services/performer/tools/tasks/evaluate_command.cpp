// `prehend tasks evaluate`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/arm/mounting.hpp"
#include "common/base/to_terminal.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"
#include "common/service/arguments.hpp"
#include "common/service/catalogue_argument.hpp"
#include "common/stage/process.hpp"
#include "common/stage/temporary_folder.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/performer/tools/tasks/commands.hpp"
#include "services/performer/tools/trials/lab_things.hpp"
#include "services/performer/tools/trials/trial.hpp"

namespace prehend::performer {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  service::CatalogueArgument catalogue;
  std::string hand = model::lab_hand(), arm;
  int tasks = 20, max_steps = 4;
  std::uint64_t seed = 1;
  bool planned = false, json = false;
};

/// Where the configuration that comes with the programs has it.
planning::Robot standing(const model::ArmModel& arm, const model::HandModel& hand,
                         const service::Config& config) {
  const std::vector<double>& at = config.numbers("robot.X_WA");
  const Eigen::Quaterniond turn(at[3], at[4], at[5], at[6]);
  return {&arm, &hand, make_pose({at[0], at[1], at[2]}, turn.toRotationMatrix()),
          arm.X_EF * arm::mounted(hand, config.number("robot.bracket"))};
}

/// One task that was shown, and what came of it.
struct Tried {
  int steps = 0;
  bool understood = false;
  TaskTrial trial;
};

Json entry_of(const Tried& tried, std::uint64_t seed) {
  const TaskTrial& trial = tried.trial;
  return {{"seed", seed},
          {"steps", tried.steps},
          {"understood", tried.understood},
          {"rehearsed", trial.rehearsed},
          {"planned", trial.planned},
          {"done", trial.done},
          {"max_error_m", trial.max_error},
          {"max_turn_rad", trial.max_turn},
          {"reason", trial.reason}};
}

/// The demonstration draws it, shows it and learns it; then it is done again.
Tried try_one(const EvaluateArguments& arguments, const model::HandModel& hand,
              const model::Catalogue& catalogue, LabThings& lab, int steps, std::uint64_t seed,
              const std::optional<planning::Robot>& robot) {
  Tried tried{.steps = steps};
  const auto refuse = [&](const std::string& reason) {
    tried.trial.reason = reason;
    return tried;
  };
  const auto folder = stage::TemporaryFolder::create(false);
  if (!folder) return refuse(folder.error().message());
  std::vector<std::string> words{"show",    folder->path().string(), "--hand", arguments.hand,
                                 "--steps", std::to_string(steps),   "--seed", std::to_string(seed),
                                 "--json"};
  for (const auto& [option, value] : {std::pair("--catalogue", &arguments.catalogue.file),
                                      std::pair("--config", &arguments.catalogue.config)})
    if (!value->empty()) words.insert(words.end(), {option, *value});
  if (robot) words.push_back("--by-arm");
  const auto said = stage::printed_by("prehend-demonstration-tool", words, std::chrono::minutes(1));
  if (!said) return refuse(said.error().message());
  const auto document = Json::parse(*said, nullptr, false);
  tried.understood = document.is_object() && document.value("understood", false);
  if (!tried.understood) return refuse("other steps were understood");
  const auto task = tasks::load_task(folder->path() / "trial.task");
  if (!task) return refuse(task.error().message());
  const auto scene = model::load_scene(folder->path() / "again.toml", catalogue);
  if (!scene) return refuse(scene.error().message());
  const auto things = lab.of(*scene);
  if (!things) return refuse(things.error().message());
  tried.trial = try_task(hand, *task, *things, seed, robot);
  return tried;
}

int evaluate(const EvaluateArguments& arguments) {
  const auto hand = model::HandModel::load(model::hand_directory(arguments.hand));
  if (!hand) return tool::complain(hand.error());
  const auto catalogue_file = arguments.catalogue.path();
  if (!catalogue_file) return tool::complain(catalogue_file.error());
  const auto catalogue = model::Catalogue::load(*catalogue_file);
  if (!catalogue) return tool::complain(catalogue.error());
  const auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tool::complain(bodies.error());
  LabThings lab(*hand, *bodies, arguments.planned);
  std::optional<model::ArmModel> arm;
  std::optional<planning::Robot> robot;
  if (!arguments.arm.empty()) {
    auto loaded = model::load_arm(arguments.arm);
    if (!loaded) return tool::complain(loaded.error());
    if (const auto fits = arm::check_fit(*loaded, *hand); !fits)
      return tool::complain(fits.error());
    arm = std::move(*loaded);
    const auto config = service::LabArguments{}.load();
    if (!config) return tool::complain(config.error());
    robot = standing(*arm, *hand, *config);
  }
  Json document{{"hand", hand->name()},
                {"arm", arm ? Json(arm->name) : Json(nullptr)},
                {"tasks", Json::array()}};
  int understood = 0, rehearsed = 0, done = 0, steps = 0, planned = 0;
  for (int n = 0; n < arguments.tasks; ++n) {
    const std::uint64_t seed = arguments.seed + static_cast<std::uint64_t>(n);
    const Tried tried =
        try_one(arguments, *hand, *catalogue, lab, 1 + n % arguments.max_steps, seed, robot);
    const TaskTrial& trial = tried.trial;
    understood += tried.understood;
    rehearsed += trial.rehearsed;
    done += trial.done;
    steps += trial.rehearsed ? tried.steps : 0;
    planned += trial.planned;
    document["tasks"].push_back(entry_of(tried, seed));
    if (arguments.json) continue;
    to_terminal("{:4} {} steps, {} planned: {:10} {:5.1f} mm {:5.1f}°  {}\n", seed, tried.steps,
                trial.planned,
                trial.done        ? "done"
                : trial.rehearsed ? "not done"
                                  : "not tried",
                1000 * trial.max_error, trial.max_turn * 57.29578, trial.reason);
    std::fflush(stdout);
  }
  document["understood"] = understood;
  document["rehearsed"] = rehearsed;
  document["rehearsed_steps"] = steps;
  document["planned_steps"] = planned;
  document["done"] = done;
  if (arguments.json)
    std::cout << document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  else
    to_terminal(
        "{} tasks: {} understood, {} rehearsed, {} done; of {} steps {} by planned grasps\n",
        arguments.tasks, understood, rehearsed, done, steps, planned);
  return exit_done;
}

}  // namespace

void add_evaluate(tool::Program& program) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = program.app().add_subcommand(
      "evaluate",
      "Tasks that are drawn, shown once by people who do not exist, and done again elsewhere in a "
      "simulated\nworld: how many are understood and done as they were shown?");
  command->add_option("--hand", arguments->hand, "the robot hand")->capture_default_str();
  command->add_option("--arm", arguments->arm,
                      "the arm that carries it, a name or folder: puma560; else it flies");
  arguments->catalogue.add_to(*command);
  command->add_option("--tasks", arguments->tasks, "how many")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--max-steps", arguments->max_steps, "tasks have 1 to so many steps, in turn")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "of the first one")->capture_default_str();
  command->add_flag("--planned", arguments->planned,
                    "also with the grasps that prehend-planner finds for what it sees");
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return evaluate(*arguments); });
}

}  // namespace prehend::performer
