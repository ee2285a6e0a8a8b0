// `prehend arm solve`: inverse kinematics, all branches.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/arm/inverse.hpp"
#include "common/base/finite_number.hpp"
#include "common/base/to_terminal.hpp"
#include "common/model/arm_choice.hpp"
#include "services/planner/tools/arm/commands.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;

struct SolveArguments {
  std::string arm, pose, frame = "shoulder";
  bool json = false;
};

Expected<Pose> pose_from(const std::string& text) {
  constexpr const char* form = "write x,y,z,qw,qx,qy,qz: metres, and a quaternion";
  const auto numbers = finite_list(text);
  if (!numbers) return wrong_use("must be seven finite numbers", "--pose=" + text, form);
  const std::vector<double>& values = *numbers;
  if (values.size() != 7)
    return wrong_use(fmt::format("has {} numbers in place of 7", values.size()), "--pose=" + text,
                     form);
  auto X =
      checked_pose({values[0], values[1], values[2]}, {values[3], values[4], values[5], values[6]});
  if (!X) return wrong_use(X.error().what, "--pose=" + text, form);
  return *X;
}

Json document_of(const model::ArmModel& arm, const std::vector<arm::Joints>& postures) {
  Json solutions = Json::array();
  for (const arm::Joints& q : postures) {
    Json solution{{"joints_rad", std::vector<double>(q.begin(), q.end())},
                  {"within_limits", arm::is_within_limits(arm, q)}};
    if (solution["within_limits"]) {
      const auto turns = arm::turns_within_limits(arm, q);
      solution["turned_rad"] = Json::array();  // the same posture by whole turns
      for (std::size_t k = 1; k < turns.size(); ++k)
        solution["turned_rad"].push_back(std::vector<double>(turns[k].begin(), turns[k].end()));
    }
    solutions.push_back(std::move(solution));
  }
  return {{"solutions", std::move(solutions)}};
}

void print(const model::ArmModel& arm, const std::vector<arm::Joints>& postures) {
  for (const arm::Joints& q : postures) {
    std::string line;
    for (const double angle : q) line += fmt::format("{:9.2f}", angle * 180 / std::numbers::pi);
    to_terminal("{}  {}\n", line,
                arm::is_within_limits(arm, q)
                    ? fmt::format("{} by whole turns", arm::turns_within_limits(arm, q).size())
                    : "outside the limits");
  }
  to_terminal("{} solution{}, degrees\n", postures.size(), postures.size() == 1 ? "" : "s");
}

int run_solve(const SolveArguments& arguments) {
  const auto X = pose_from(arguments.pose);
  if (!X) return tool::complain(X.error());
  const auto arm = model::load_arm(arguments.arm);
  if (!arm) return tool::complain(arm.error());
  const Pose X_AE = arguments.frame == "shoulder" ? arm->X_AS * *X : *X;
  const auto postures = arm::Inverse(*arm).branches(X_AE);
  if (arguments.json)
    std::cout << document_of(*arm, postures).dump(2) << "\n";
  else if (!postures.empty())
    print(*arm, postures);
  if (postures.empty())
    return tool::complain({fmt::format("out of reach: {:.3f} m from the shoulder",
                                       (X_AE.translation() - arm->X_AS.translation()).norm()),
                           "--pose=" + arguments.pose,
                           fmt::format("{} reaches {:.3f} m at most; try another place or turn",
                                       arm->name, arm::reach_bound(*arm)),
                           exit_no});
  if (!arm::is_within_limits(*arm, postures.front()))
    return tool::complain({"no posture is within the limits of the joints",
                           "--pose=" + arguments.pose, "try another place or turn", exit_no});
  return exit_done;
}

}  // namespace

void add_solve(tool::Program& program) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App* command = program.app().add_subcommand(
      "solve",
      "Inverse kinematics: all postures that put the arm's end there.\n"
      "Exit code 0: some are within the limits, 1: none is, 2: wrong use.");
  command->add_option("ARM", arguments->arm, "an arm's name or folder")->required();
  command->add_option("--pose", arguments->pose, "x,y,z,qw,qx,qy,qz: metres, and a quaternion")
      ->required();
  command->add_option("--frame", arguments->frame, "in which the pose is told")
      ->capture_default_str()
      ->check(CLI::IsMember({"shoulder", "base"}));
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  program.on(*command, [arguments] { return run_solve(*arguments); });
}

}  // namespace prehend::planner
