#include "services/cli/tools/demo/scene_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/model/hand_model.hpp"
#include "common/service/arguments.hpp"
#include "services/cli/tools/demo/carry_setting.hpp"
#include "services/cli/tools/demo/setting.hpp"

namespace prehend::cli {
namespace {

/// What two hands do together, which takes a catalogue of its own.
struct CarryWishes {
  std::vector<std::string> hands;
  std::string task = "carry", catalogue;

  void add_to(CLI::App& app, CLI::Option* object, CLI::Option* output) {
    auto* two = app.add_option("--hands", hands,
                               "left:HAND,right:HAND: what both carry together, as with demo")
                    ->delimiter(',')
                    ->allow_extra_args(false);
    auto* file = app.add_option("--catalogue", catalogue,
                                "file to write with --hands: what is carried, as lab.catalogue");
    app.add_option("--task", task, "carry or hand-over")
        ->check(CLI::IsMember({"carry", "hand-over"}))
        ->needs(two);
    two->needs(file)->needs(output)->excludes(object);
    file->needs(two);
  }
};

int draw_carry(const CarryWishes& wishes, std::uint64_t seed, const std::string& output) {
  const auto hands = read_hands(wishes.hands);
  if (!hands) return service::complain(hands.error());
  const auto setting = make_carry_setting(
      wishes.task == "carry" ? CarryTask::carry : CarryTask::hand_over, seed, hands->right);
  if (!setting) return service::complain(setting.error(), exit_wrong_use);
  if (const auto written = write_carry_setting(*setting, wishes.catalogue, output); !written)
    return service::complain(written.error(), exit_broken);
  return exit_done;
}

}  // namespace

int scene_command(const std::vector<std::string>& arguments) {
  CLI::App app{"Draws a scene from a seed: objects on the table, light and person.",
               "prehend scene"};
  service::LabArguments lab;
  SettingOptions wishes;
  std::string output;
  lab.add_to(app);
  app.add_option("--seed", wishes.seed, "the same seed draws the same scene");
  auto* object = app.add_option("--object", wishes.object, "what is reached for");
  auto* file = app.add_option("--output", output, "file to write; otherwise standard output");
  CarryWishes carried;
  carried.add_to(app, object, file);
  if (const auto code = service::parse(app, arguments)) return *code;
  if (!carried.hands.empty()) return draw_carry(carried, wishes.seed, output);

  const auto config = lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  wishes.catalogue = config->path("lab.catalogue");
  wishes.hand = model::hand_directory(config->text("simulation.hand"));
  const auto scene = make_setting(wishes);
  if (!scene) return service::complain(scene.error(), exit_wrong_use);
  if (output.empty()) {
    std::cout << model::to_toml(*scene);
    return exit_done;
  }
  if (const auto written = write_setting(*scene, output); !written)
    return service::complain(written.error(), exit_broken);
  return exit_done;
}

}  // namespace prehend::cli
