// `prehend arm reach`: what an arm with a hand can grasp on a table, by the height of its shoulder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/arm/mounting.hpp"
#include "common/arm/reach.hpp"
#include "common/base/gnuplot.hpp"
#include "common/base/to_terminal.hpp"
#include "common/model/arm_choice.hpp"
#include "services/planner/tools/arm/commands.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array approach_names{"above", "slanted", "level"};
constexpr double palm = 0.12;  // m, from the flange to what is grasped, without a hand

struct ReachArguments {
  std::string arm, hand, output;
  int places = 60;
  bool json = false;
};

Expected<arm::ReachTask> task_of(const model::ArmModel& arm, const ReachArguments& arguments) {
  arm::ReachTask task;
  task.places = arguments.places;
  task.X_EG = arm.X_EF;
  if (arguments.hand.empty()) {
    task.X_EG.translate(Eigen::Vector3d(0, 0, palm));
    return task;
  }
  const auto folder = model::hand_directory(arguments.hand);
  if (!model::is_hand(folder))
    return wrong_use("there is no such hand", "'" + arguments.hand + "'", model::hand_hint());
  const auto hand = model::HandModel::load(folder);
  if (!hand) return tl::unexpected(hand.error());
  task.X_EG = arm.X_EF * arm::mounted(*hand) * hand->X_BG();
  task.carried = arm::carried(arm, *hand);
  return task;
}

Json document_of(const ReachArguments& arguments, const std::vector<arm::ReachRow>& rows) {
  Json document{{"arm", arguments.arm},
                {"hand", arguments.hand.empty() ? Json(nullptr) : Json(arguments.hand)},
                {"best_shoulder_m", arm::best(rows).height}};
  document["heights"] = Json::array();
  for (const arm::ReachRow& row : rows) {
    Json entry{{"shoulder_m", row.height}};
    for (std::size_t k = 0; k < row.shares.size(); ++k)
      entry[approach_names[k]] = {{"within_limits", row.shares[k].limits},
                                  {"free", row.shares[k].free}};
    document["heights"].push_back(std::move(entry));
  }
  return document;
}

void print(const std::vector<arm::ReachRow>& rows) {
  to_terminal(
      "shoulder above   places reached, % (without a touch, % within limits only)\n"
      "the table, m     from above         slanted            level\n");
  for (const arm::ReachRow& row : rows) {
    to_terminal("{:<17.2f}", row.height);
    for (const arm::Share& share : row.shares)
      to_terminal("{:3.0f} ({:3.0f})          ", 100 * share.free, 100 * share.limits);
    to_terminal("\n");
  }
  to_terminal("best with the shoulder at {:.2f} m\n", arm::best(rows).height);
}

Expected<void> draw(const std::vector<arm::ReachRow>& rows, const std::string& png) {
  std::string commands =
      "set xlabel 'height of the shoulder above the table, m'\nset ylabel 'places reached, %'\n"
      "set yrange [0:100]\nset key outside top center horizontal\nset grid lc rgb '#dddddd'\n"
      "$rows << EOD\n";
  for (const arm::ReachRow& row : rows)
    commands += fmt::format("{} {} {} {}\n", row.height, 100 * row.shares[0].free,
                            100 * row.shares[1].free, 100 * row.shares[2].free);
  commands +=
      "EOD\nplot $rows using 1:2 with linespoints lw 2 title 'from above', "
      "$rows using 1:3 with linespoints lw 2 title 'slanted', "
      "$rows using 1:4 with linespoints lw 2 title 'level'\n";
  return draw_by_gnuplot(commands, png, 800, 480);
}

int run_reach(const ReachArguments& arguments) {
  const auto arm = model::load_arm(arguments.arm);
  if (!arm) return tool::complain(arm.error());
  const auto task = task_of(*arm, arguments);
  if (!task) return tool::complain(task.error());
  std::vector<arm::ReachRow> rows;
  for (int step = 1; step <= 11; ++step) rows.push_back(arm::reach_at(*arm, *task, 0.1 * step));
  if (!arguments.output.empty())
    if (const auto drawn = draw(rows, arguments.output); !drawn)
      return tool::complain(drawn.error());
  if (arguments.json)
    std::cout << document_of(arguments, rows).dump(2) << "\n";
  else
    print(rows);
  if (arm::best(rows).least() > 0) return exit_done;
  return tool::complain({"there is an approach from which it reaches nothing", arguments.arm,
                         "use a longer arm or another hand", exit_no});
}

}  // namespace

void add_reach(tool::Program& program) {
  auto arguments = std::make_shared<ReachArguments>();
  CLI::App* command = program.app().add_subcommand(
      "reach",
      "What an arm can grasp 25 to 75 cm before it on a table, 35 cm to each side, and how high "
      "its\n"
      "shoulder should be for that. Exit code 0: told, 1: it reaches nothing, 2: wrong use.");
  command->add_option("ARM", arguments->arm, "an arm's name or folder")->required();
  command->add_option("--hand", arguments->hand, "the hand that it carries");
  command->add_option("--places", arguments->places, "that are tried for each height and approach")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  command->add_option("--output,-o", arguments->output, "a picture, PNG");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  program.on(*command, [arguments] { return run_reach(*arguments); });
}

}  // namespace prehend::planner
