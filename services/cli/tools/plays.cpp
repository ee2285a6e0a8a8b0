#include "services/cli/tools/plays.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "services/cli/tools/demo/carry_command.hpp"
#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/demo_command.hpp"
#include "services/cli/tools/dispatch.hpp"

namespace prehend::cli {
namespace {

/// What decides who plays; the play itself reads all arguments.
struct Choice {
  std::string task, record, robot, hand, hands, mode;
  bool watch = false, targets = false;
};

Choice chosen_by(std::vector<std::string> arguments) {
  Choice choice;
  CLI::App app;
  app.allow_extras();
  app.set_help_flag();
  app.add_option("--task", choice.task);
  app.add_option("--record", choice.record);
  app.add_option("--robot", choice.robot);
  app.add_option("--hand", choice.hand);
  app.add_option("--hands", choice.hands);
  app.add_option("--mode", choice.mode);
  app.add_flag("--watch", choice.watch);
  app.add_flag("--targets", choice.targets);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError&) {
    // The play says what is wrong.
  }
  return choice;
}

std::string targets_of(const Choice& choice) {
  if (!choice.task.empty() && choice.hands.empty()) return "task_lab";
  std::string targets = "lab";
  if (choice.task == "hand-over") targets += " prehend-person";
  if (!choice.record.empty()) targets += " prehend-record";
  if (!choice.robot.empty()) targets += " prehend-robot prehend-robot-tool";
  // A user's hand is trained on first use.
  if (!is_ours(choice.hand)) targets += " prehend-train";
  if (is_planned_for(choice.hand, choice.mode)) targets += " prehend-planner";
  if (choice.watch) targets += " prehend-console prehend-teacher";
  return targets;
}

}  // namespace

int play(const std::vector<std::string>& arguments) {
  const Choice choice = chosen_by(arguments);
  if (choice.targets) {
    std::cout << targets_of(choice) << "\n";
    return exit_done;
  }
  if (!choice.hands.empty()) return carry_command(arguments);
  if (choice.task.empty()) return demo_command(arguments);
  std::vector<std::string> command{"demo"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return become({"tasks", "prehend-tasks", ""}, command);
}

}  // namespace prehend::cli
