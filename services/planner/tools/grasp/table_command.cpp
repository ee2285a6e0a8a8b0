// `prehend grasp table`: hands by objects, the best planned grasp of each pair.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

struct TableArguments {
  service::CatalogueArgument catalogue;
  std::vector<std::string> hands, objects;
  std::string save;
  grasping::PlanOptions options;
  int most = 0;  // candidates, up to which a pair of which none held is planned again
  unsigned threads = 0;
  bool json = false, markdown = false, resume = false;
};

struct Row {
  grasping::Body object;
  std::vector<grasping::Plan> plans;  // of each hand
};

Json cell_json(const grasping::Plan& plan) {
  Json made{{"hand", plan.hand},
            {"object", plan.object.name},
            {"held", plan.held()},
            {"epsilon", nullptr},
            {"lift", nullptr},
            {"shake", nullptr},
            {"turned_over", nullptr},
            {"closed", plan.closed},
            {"tested", plan.grasps.size()},
            {"reason", nullptr}};
  if (!plan.reason.empty()) made["reason"] = plan.reason;
  if (plan.grasps.empty()) return made;
  const grasping::PlannedGrasp& best = plan.grasps.front();
  const auto phase = [](const std::optional<bool>& survived) {
    return survived ? Json(*survived) : Json();
  };
  made["epsilon"] = best.quality.epsilon;
  made["lift"] = phase(best.hold.lift);
  made["shake"] = phase(best.hold.shake);
  made["turned_over"] = phase(best.hold.turned_over);
  return made;
}

/// Epsilon and what was survived; a number where there is a reason to be read below.
std::string cell(const grasping::Plan& plan, std::vector<std::string>& notes) {
  if (plan.held()) return fmt::format("{:.3f} held", plan.grasps.front().quality.epsilon);
  auto at = std::find(notes.begin(), notes.end(), plan.reason);
  if (at == notes.end()) at = notes.insert(notes.end(), plan.reason);
  const auto number = at - notes.begin() + 1;
  if (plan.grasps.empty()) return fmt::format("none ({})", number);
  return fmt::format("{:.3f} not held ({})", plan.grasps.front().quality.epsilon, number);
}

void print(const std::vector<model::HandModel>& hands, const std::vector<Row>& rows) {
  std::vector<std::string> names, notes;
  for (const model::HandModel& hand : hands) names.push_back(hand.name());
  to_terminal("| object | {} |\n|---|{}\n", fmt::join(names, " | "),
              fmt::join(std::vector<std::string>(hands.size(), "---|"), ""));
  for (const Row& row : rows) {
    std::vector<std::string> cells;
    for (const grasping::Plan& plan : row.plans) cells.push_back(cell(plan, notes));
    to_terminal("| {} | {} |\n", row.object.name, fmt::join(cells, " | "));
  }
  to_terminal("\n");
  for (std::size_t i = 0; i < notes.size(); ++i) to_terminal("{}. {}\n", i + 1, notes[i]);
}

/// Most pairs need few candidates: one of which none held is planned again with four times as many.
bool goes_on(const grasping::Plan& plan, const TableArguments& arguments) {
  return !plan.held() && 4 * plan.options.candidates <= arguments.most;
}

Expected<grasping::Plan> plan_pair(const model::HandModel& hand, const grasping::Body& object,
                                   const TableArguments& arguments) {
  grasping::PlanOptions options = arguments.options;
  while (true) {
    auto plan = plan_with_progress(hand, object, options, arguments.threads);
    if (!plan || !goes_on(*plan, arguments)) return plan;
    options.candidates *= 4;
  }
}

/// The plan that an earlier run has left in the file, if it was made with these options.
std::optional<grasping::Plan> left_by_earlier_run(const std::filesystem::path& file,
                                                  const TableArguments& arguments) {
  auto plan = load_plan(file);
  if (!plan || plan->options.seed != arguments.options.seed) return std::nullopt;
  int candidates = arguments.options.candidates;
  while (candidates < plan->options.candidates) candidates *= 4;
  if (candidates != plan->options.candidates || goes_on(*plan, arguments)) return std::nullopt;
  return std::move(*plan);
}

int table(const TableArguments& arguments) {
  std::vector<model::HandModel> hands;
  for (const std::string& name : arguments.hands.empty() ? model::hand_names() : arguments.hands) {
    auto hand = find_hand(name);
    if (!hand) return tool::complain(hand.error(), exit_wrong_use);
    hands.push_back(std::move(*hand));
  }
  const auto objects = catalogue_bodies(arguments.catalogue, arguments.objects);
  if (!objects) return tool::complain(objects.error(), exit_wrong_use);
  const auto before = std::chrono::steady_clock::now();
  std::vector<Row> rows;
  for (const grasping::Body& object : *objects) {
    Row row{object, {}};
    for (const model::HandModel& hand : hands) {
      const auto file = std::filesystem::path(arguments.save) /
                        fmt::format("{} {}.grasps", hand.name(), object.name);
      if (arguments.resume)
        if (auto earlier = left_by_earlier_run(file, arguments)) {
          row.plans.push_back(std::move(*earlier));
          continue;
        }
      auto plan = plan_pair(hand, object, arguments);
      if (!plan) return tool::complain(plan.error(), exit_wrong_use);
      if (!arguments.save.empty()) {
        if (const auto saved = save(file, *plan); !saved) {
          log::error(saved.error());
          return 3;
        }
      }
      row.plans.push_back(std::move(*plan));
    }
    rows.push_back(std::move(row));
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  if (!arguments.json) {
    print(hands, rows);
    log::info("{:.0f} s", seconds);
    return 0;
  }
  Json document{{"seed", arguments.options.seed},
                {"candidates", arguments.options.candidates},
                {"seconds", seconds},
                {"grasps", Json::array()}};
  for (const Row& row : rows)
    for (const grasping::Plan& plan : row.plans) document["grasps"].push_back(cell_json(plan));
  std::cout << document.dump(2) << "\n";
  return 0;
}

}  // namespace

void add_table(tool::Program& program) {
  auto arguments = std::make_shared<TableArguments>();
  CLI::App* command = program.app().add_subcommand(
      "table",
      "Plans grasps of every object with every hand: epsilon of the best that held, or why none\n"
      "did. Exit code 0: done, 2: wrong use, 3: cannot be written.");
  command->add_option("--hands", arguments->hands, "names or folders; else all of the lab");
  command->add_option("--objects", arguments->objects, "names; else the whole catalogue");
  arguments->catalogue.add_to(*command);
  command->add_option("--candidates", arguments->options.candidates, "of each pair")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option(
          "--most", arguments->most,
          "candidates; a pair of which none held is planned again with four times as many,\n"
          "up to this")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--seed", arguments->options.seed, "of the sampling")->capture_default_str();
  command->add_option("--threads", arguments->threads, "0: one a core; the answer is the same")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  auto* save =
      command->add_option("--save", arguments->save, "folder for the grasps, a file a pair");
  command->add_flag("--resume", arguments->resume, "take what an earlier run has saved there")
      ->needs(save);
  auto* json = command->add_flag("--json", arguments->json, "one JSON document");
  command->add_flag("--markdown", arguments->markdown, "a table to be read, as without it")
      ->excludes(json);
  program.on(*command, [arguments] { return table(*arguments); });
}

}  // namespace prehend::planner
