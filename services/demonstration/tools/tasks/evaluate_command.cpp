// `prehend tasks evaluate`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/arm/mounting.hpp"
#include "common/base/paths.hpp"
#include "common/model/arm_choice.hpp"
#include "services/demonstration/tools/tasks/commands.hpp"
#include "services/demonstration/tools/trials/trial.hpp"

namespace prehend::demonstration {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string hand = model::lab_hand(), arm;
  int tasks = 20, max_steps = 4;
  std::uint64_t seed = 1;
  bool json = false;
};

/// Where the configuration's defaults have it.
planning::Robot standing(const model::ArmModel& arm, const model::HandModel& hand) {
  constexpr double before = 0.7, bracket = 0.7;  // m, rad
  const Eigen::AngleAxisd turn(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  return {&arm, &hand, make_pose({0, -before, 0}, turn.toRotationMatrix()),
          arm.X_EF * arm::mounted(hand, bracket)};
}

Json entry_of(const TaskTrial& trial, std::uint64_t seed) {
  return {{"seed", seed},
          {"steps", trial.steps},
          {"understood", trial.understood},
          {"rehearsed", trial.rehearsed},
          {"done", trial.done},
          {"max_error_m", trial.max_error},
          {"max_turn_rad", trial.max_turn},
          {"reason", trial.reason}};
}

int evaluate(const EvaluateArguments& arguments) {
  const auto hand = model::HandModel::load(model::hand_directory(arguments.hand));
  if (!hand) return tool::complain(hand.error());
  const auto catalogue =
      model::Catalogue::load(share_directory() / "models" / "objects" / "catalogue.toml");
  if (!catalogue) return tool::complain(catalogue.error());
  std::optional<model::ArmModel> arm;
  std::optional<planning::Robot> robot;
  if (!arguments.arm.empty()) {
    auto loaded = model::load_arm(arguments.arm);
    if (!loaded) return tool::complain(loaded.error());
    if (const auto fits = arm::check_fit(*loaded, *hand); !fits)
      return tool::complain(fits.error());
    arm = std::move(*loaded);
    robot = standing(*arm, *hand);
  }
  Json document{{"hand", hand->name()},
                {"arm", arm ? Json(arm->name) : Json(nullptr)},
                {"tasks", Json::array()}};
  int understood = 0, rehearsed = 0, done = 0;
  for (int n = 0; n < arguments.tasks; ++n) {
    const std::uint64_t seed = arguments.seed + static_cast<std::uint64_t>(n);
    const TaskTrial trial = try_task(*hand, *catalogue, 1 + n % arguments.max_steps, seed, robot);
    understood += trial.understood;
    rehearsed += trial.rehearsed;
    done += trial.done;
    document["tasks"].push_back(entry_of(trial, seed));
    if (arguments.json) continue;
    fmt::print("{:4} {} steps: {:10} {:5.1f} mm {:5.1f}°  {}\n", seed, trial.steps,
               trial.done        ? "done"
               : trial.rehearsed ? "not done"
                                 : "not tried",
               1000 * trial.max_error, trial.max_turn * 57.29578, trial.reason);
    std::fflush(stdout);
  }
  document["understood"] = understood;
  document["rehearsed"] = rehearsed;
  document["done"] = done;
  if (arguments.json)
    std::cout << document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  else
    fmt::print("{} tasks: {} understood, {} rehearsed, {} done\n", arguments.tasks, understood,
               rehearsed, done);
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
  command->add_option("--tasks", arguments->tasks, "how many")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--max-steps", arguments->max_steps, "tasks have 1 to so many steps, in turn")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "of the first one")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return evaluate(*arguments); });
}

}  // namespace prehend::demonstration
