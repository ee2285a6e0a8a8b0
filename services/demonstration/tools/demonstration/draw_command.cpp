// `prehend demonstration draw`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/to_terminal.hpp"
#include "services/demonstration/core/showing/people.hpp"
#include "services/demonstration/files/takes_file.hpp"
#include "services/demonstration/tools/demonstration/commands.hpp"

namespace prehend::demonstration {
namespace {

struct DrawArguments {
  std::string folder;
  DrawOptions options;
  bool json = false;
};

int draw(const DrawArguments& arguments) {
  const auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tool::complain(taxonomy.error());
  const auto takes = drawn_takes(*taxonomy, arguments.options);
  if (!takes) return tool::complain(takes.error());
  std::error_code error;
  std::filesystem::create_directories(arguments.folder, error);
  if (error) return tool::complain({error.message(), arguments.folder, "choose another folder"});
  const auto file = std::filesystem::path(arguments.folder) / "task_kinds.csv";
  if (const auto written = write_file(file, takes_csv(*takes)); !written)
    return tool::complain(written.error());
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"file", file.string()},
                                        {"people", arguments.options.people},
                                        {"kinds", measured_kinds.size()},
                                        {"takes", takes->size()}}
              << "\n";
  else
    to_terminal("{}: {} takes of {} people who do not exist\n", file.string(), takes->size(),
                arguments.options.people);
  return exit_done;
}

}  // namespace

void add_draw(tool::Program& program) {
  auto arguments = std::make_shared<DrawArguments>();
  CLI::App* command = program.app().add_subcommand(
      "draw",
      "Takes of people who do not exist, of ten of Cutkosky's kinds of grasps: each has a hand and "
      "habits of his\nown. Writes task_kinds.csv.");
  command->add_option("folder", arguments->folder, "is made if it is not there")->required();
  command->add_option("--people", arguments->options.people, "how many")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--takes", arguments->options.trials, "of each kind by each person")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "of all that is drawn")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return draw(*arguments); });
}

}  // namespace prehend::demonstration
