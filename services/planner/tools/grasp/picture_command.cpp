// `prehend grasp picture`: a planned grasp as a picture, without a display.
#include <CLI/CLI.hpp>
#include <memory>

#include "common/base/log.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"
#include "services/planner/tools/picture/grasp_picture.hpp"
#include "services/planner/tools/planning/grasp_file.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

struct PictureArguments {
  std::string file, hand, output;
  int index = 0, width = 960, height = 720;
};

int draw(const PictureArguments& arguments) {
  const auto plan = load_plan(arguments.file);
  if (!plan) return tool::complain(plan.error(), exit_wrong_use);
  if (arguments.index >= static_cast<int>(plan->grasps.size())) {
    log::error("{} has {} grasps (count from 0)", arguments.file, plan->grasps.size());
    return 2;
  }
  const auto hand = find_hand(arguments.hand.empty() ? plan->hand : arguments.hand);
  if (!hand) return tool::complain(hand.error(), exit_wrong_use);
  const auto& grasp = plan->grasps[static_cast<std::size_t>(arguments.index)];
  const auto scene = draw_grasp(*hand, plan->object, grasp);
  if (!scene) return tool::complain(scene.error(), exit_wrong_use);
  const Viewpoint view = best_view(*scene, static_cast<double>(arguments.width) / arguments.height);
  const Raster raster = scene->drawing.draw(view, arguments.width, arguments.height);
  if (const auto saved = save(arguments.output, raster); !saved)
    return tool::complain(saved.error(), exit_broken);
  return 0;
}

}  // namespace

void add_picture(tool::Program& program) {
  auto arguments = std::make_shared<PictureArguments>();
  CLI::App* command = program.app().add_subcommand(
      "picture",
      "A planned grasp as PNG or JPEG: hand, object, contacts and their friction cones.\n"
      "Exit code 0: done, 2: wrong use or file, 3: cannot be written.");
  command->add_option("FILE", arguments->file, "that `prehend grasp plan --output` wrote")
      ->required();
  command->add_option("--output,-o", arguments->output, "picture to write")->required();
  command->add_option("--index", arguments->index, "which grasp, from 0: the best")
      ->capture_default_str()
      ->check(CLI::Range(0, 1'000'000));
  command->add_option("--hand", arguments->hand, "folder of the hand, if it is none of the lab");
  command->add_option("--width", arguments->width, "px")
      ->capture_default_str()
      ->check(CLI::Range(64, 4096));
  command->add_option("--height", arguments->height, "px")
      ->capture_default_str()
      ->check(CLI::Range(64, 4096));
  program.on(*command, [arguments] { return draw(*arguments); });
}

}  // namespace prehend::planner
