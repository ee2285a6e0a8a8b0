// `prehend grasp plan`: finds grasps of an object by closing the hand in simulation.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "common/grasping/blocking.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/planning/export.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

struct PlanArguments {
  service::CatalogueArgument catalogue;
  std::string hand, object, output;
  grasping::PlanOptions options;
  unsigned threads = 0;
  bool json = false;
};

/// Which fingers of the closed hand keep each other from opening; empty: none.
std::string blocking_of(const model::HandModel& hand, const grasping::PlannedGrasp& grasp) {
  const auto found = grasping::find_blocking(hand, grasp.joints);
  return found ? grasping::to_string(*found, hand) : std::string();
}

void print(const model::HandModel& hand, const grasping::Plan& plan) {
  for (std::size_t i = 0; i < plan.grasps.size(); ++i) {
    const grasping::PlannedGrasp& grasp = plan.grasps[i];
    to_terminal("{:3}  epsilon {:.4f}  {:2} contacts  {}\n", i, grasp.quality.epsilon,
                grasp.contacts.size(), describe(grasp.hold));
    if (const std::string blocking = blocking_of(hand, grasp); !blocking.empty())
      to_terminal("     {}\n", blocking);
  }
  to_terminal("{} of {} candidates closed with force closure\n", plan.closed,
              plan.options.candidates);
  for (const auto& [reason, count] : plan.refused) to_terminal("{:5}  {}\n", count, reason);
  if (!plan.reason.empty()) to_terminal("no grasp: {}\n", plan.reason);
}

int plan(const PlanArguments& arguments) {
  const auto hand = find_hand(arguments.hand);
  if (!hand) return tool::complain(hand.error(), exit_wrong_use);
  const auto object = find_body(arguments.catalogue, arguments.object);
  if (!object) return tool::complain(object.error(), exit_wrong_use);
  const auto before = std::chrono::steady_clock::now();
  const auto planned = plan_with_progress(*hand, *object, arguments.options, arguments.threads);
  if (!planned) return tool::complain(planned.error(), exit_wrong_use);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  if (!arguments.output.empty())
    if (const auto saved = save(arguments.output, *planned); !saved) {
      log::error(saved.error());
      return 3;
    }
  if (arguments.json) {
    nlohmann::ordered_json document = summary_json(*planned);
    document["seconds"] = seconds;
    document["grasps"] = nlohmann::ordered_json::array();
    for (const auto& grasp : planned->grasps) {
      document["grasps"].push_back(to_json(*planned, grasp));
      document["grasps"].back()["blocking"] = blocking_of(*hand, grasp);
    }
    std::cout << document.dump(2) << "\n";
  } else {
    print(*hand, *planned);
    to_terminal("{:.1f} s\n", seconds);
  }
  return planned->held() ? 0 : 1;
}

}  // namespace

void add_plan(tool::Program& program) {
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command = program.app().add_subcommand(
      "plan",
      "Finds grasps of an object: candidates are sampled around it, closed in simulation, ranked\n"
      "by epsilon, and the best lifted, shaken and turned upside down. Exit code 0: a grasp held,\n"
      "1: none did (the answer says why), 2: wrong use.");
  command->add_option("--hand", arguments->hand, "name of a hand, or a folder with one")
      ->required();
  command->add_option("--object", arguments->object, "name of an object of the catalogue")
      ->required();
  arguments->catalogue.add_to(*command);
  command->add_option("--candidates", arguments->options.candidates, "how many are sampled")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--seed", arguments->options.seed, "of the sampling")->capture_default_str();
  command->add_flag("--table", arguments->options.table,
                    "the object stands on a table, through which no hand may reach");
  command->add_option("--threads", arguments->threads, "0: one a core; the answer is the same")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  command->add_option("--output,-o", arguments->output, "file for the grasps");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  program.on(*command, [arguments] { return plan(*arguments); });
}

}  // namespace prehend::planner
