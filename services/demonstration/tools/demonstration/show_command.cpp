// `prehend demonstration show`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/to_terminal.hpp"
#include "common/service/catalogue_argument.hpp"
#include "common/tasks/files/task_file.hpp"
#include "services/demonstration/tools/demonstration/commands.hpp"
#include "services/demonstration/tools/trials/trial.hpp"

namespace prehend::demonstration {
namespace {

struct ShowArguments {
  service::CatalogueArgument catalogue;
  std::string folder, hand = model::lab_hand();
  int steps = 1;
  std::uint64_t seed = 1;
  bool by_arm = false, json = false;
};

int show(const ShowArguments& arguments) {
  const auto hand = model::HandModel::load(model::hand_directory(arguments.hand));
  if (!hand) return tool::complain(hand.error());
  const auto file = arguments.catalogue.path();
  if (!file) return tool::complain(file.error());
  const auto catalogue = model::Catalogue::load(*file);
  if (!catalogue) return tool::complain(catalogue.error());
  std::error_code code;
  std::filesystem::create_directories(arguments.folder, code);
  if (code) return tool::complain({code.message(), arguments.folder, "choose another folder"});
  const auto shown =
      show_task(*hand, *catalogue, arguments.steps, arguments.seed, arguments.by_arm);
  if (!shown) return tool::complain(shown.error(), exit_no);
  const auto folder = std::filesystem::path(arguments.folder);
  const auto task = folder / "trial.task", scene = folder / "again.toml";
  if (const auto saved = tasks::save_task(task, shown->task); !saved)
    return tool::complain(saved.error());
  if (const auto written = write_file(scene, model::to_toml(shown->again)); !written)
    return tool::complain(written.error());
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"task", task.string()},
                                        {"scene", scene.string()},
                                        {"understood", shown->understood}}
              << "\n";
  else
    to_terminal("{} and {}: {}\n", task.string(), scene.string(),
                shown->understood ? "as it was shown" : "other steps were understood");
  return exit_done;
}

}  // namespace

void add_show(tool::Program& program) {
  auto arguments = std::make_shared<ShowArguments>();
  CLI::App* command = program.app().add_subcommand(
      "show",
      "A task that is drawn, shown once by a person who does not exist, and learnt: trial.task, "
      "and "
      "the scene\nin which to do it again, again.toml. Exit code 1: nothing was learnt.");
  command->add_option("folder", arguments->folder, "where they are written")->required();
  command->add_option("--hand", arguments->hand, "the robot hand that shall do it again")
      ->capture_default_str();
  arguments->catalogue.add_to(*command);
  command->add_option("--steps", arguments->steps, "of the task")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "draws all of it")->capture_default_str();
  command->add_flag("--by-arm", arguments->by_arm, "things stand where the Puma reaches");
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return show(*arguments); });
}

}  // namespace prehend::demonstration
