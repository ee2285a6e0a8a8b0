// `prehend grasp candidates`: what prehend-planner finds for a hand and an object on the table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "common/base/workers.hpp"
#include "common/grasping/table_grasps.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

using grasping::SureGrasp;
using Clock = std::chrono::steady_clock;

struct CandidatesArguments {
  service::CatalogueArgument catalogue;
  std::string hand;
  std::vector<std::string> objects;  // none: all of the catalogue
  grasping::SearchOptions options;
  unsigned threads = 0;
  bool json = false;
};

/// What the search came to, and when.
struct Searched {
  std::string object;
  std::vector<SureGrasp> grasps;
  std::map<std::string, int> refused;
  int approaches = 0, attempts = 0;
  double first = -1, seconds = 0;  // s, until the first grasp (-1: none), and until the end
};

double since(Clock::time_point before) {
  return std::chrono::duration<double>(Clock::now() - before).count();
}

Expected<Searched> searched(const model::HandModel& hand, const grasping::Body& object,
                            const CandidatesArguments& arguments) {
  const auto before = Clock::now();
  auto search = grasping::TableGraspSearch::create(hand, object, arguments.options);
  if (!search) return tl::unexpected(search.error());
  Searched made{object.name, {}, {}, 0, 0, -1, 0};
  made.approaches = static_cast<int>(grasping::approaches(object.shape, hand.reach()).size());
  const auto in_threads = [&](std::size_t count, const auto& work) {
    share_work(count, arguments.threads, work, [](std::size_t) {});
  };
  for (bool more = true; more;) {
    more = search->try_next(in_threads);
    if (made.first < 0 && !search->found().empty()) made.first = since(before);
  }
  made.grasps = search->found();
  made.refused = search->refused();
  made.attempts = search->attempts();
  made.seconds = since(before);
  return made;
}

nlohmann::ordered_json document_of(const Searched& searched) {
  nlohmann::ordered_json grasps = nlohmann::ordered_json::array();
  for (const SureGrasp& grasp : searched.grasps)
    grasps.push_back({{"from_above", grasping::is_from_above(grasp.X_OG)},
                      {"room", grasp.room},
                      {"follow_through", grasp.follow_through},
                      {"epsilon", grasp.grasp.epsilon},
                      {"attempt", grasp.tried}});
  return {{"object", searched.object},
          {"approaches", searched.approaches},
          {"attempts", searched.attempts},
          {"first_s", searched.first},
          {"seconds", searched.seconds},
          {"refused", searched.refused},
          {"grasps", grasps}};
}

void print_searched(const Searched& searched) {
  const std::string first =
      searched.first < 0 ? "none" : fmt::format("first after {:.1f} s", searched.first);
  to_terminal("{}: {} of {} approaches, {} attempts, {}, {:.1f} s\n", searched.object,
              searched.grasps.size(), searched.approaches, searched.attempts, first,
              searched.seconds);
  for (const SureGrasp& grasp : searched.grasps)
    to_terminal("  from {:5}  room {:3.0f} %  epsilon {:.3f}  attempt {}{}\n",
                grasping::is_from_above(grasp.X_OG) ? "above" : "aside", 100 * grasp.room,
                grasp.grasp.epsilon, grasp.tried,
                grasp.follow_through > 0 ? "" : "  no follow-through");
  for (const auto& [reason, count] : searched.refused) to_terminal("{:5}  {}\n", count, reason);
}

int candidates(const CandidatesArguments& arguments) {
  const auto hand = find_hand(arguments.hand);
  if (!hand) return tool::complain(hand.error(), exit_wrong_use);
  const auto bodies = catalogue_bodies(arguments.catalogue, arguments.objects);
  if (!bodies) return tool::complain(bodies.error(), exit_wrong_use);
  bool found = false;
  for (const grasping::Body& body : *bodies) {
    const auto made = searched(*hand, body, arguments);
    if (!made) return tool::complain(made.error(), exit_wrong_use);
    found = found || !made->grasps.empty();
    if (arguments.json)
      std::cout << document_of(*made).dump() << std::endl;
    else
      print_searched(*made);
  }
  return found ? exit_done : exit_no;
}

}  // namespace

void add_candidates(tool::Program& program) {
  auto arguments = std::make_shared<CandidatesArguments>();
  CLI::App* command = program.app().add_subcommand(
      "candidates",
      "Finds grasps of objects that stand on a table, from each side, as the mapping closes the\n"
      "hand, and says how much room to spare they leave. Exit code 1: none was found.");
  command->add_option("--hand", arguments->hand, "name of a hand, or a folder with one")
      ->required();
  command->add_option("--object", arguments->objects,
                      "name of an object of the catalogue, again for more; else all");
  arguments->catalogue.add_to(*command);
  command->add_option("--attempts", arguments->options.attempts, "from each side, at most")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--threads", arguments->threads, "0: one a core; the answer is the same")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  command->add_flag("--json", arguments->json, "a JSON document an object");
  program.on(*command, [arguments] { return candidates(*arguments); });
}

}  // namespace prehend::planner
