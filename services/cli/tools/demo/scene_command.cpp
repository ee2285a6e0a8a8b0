#include "services/cli/tools/demo/scene_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/model/hand_model.hpp"
#include "common/service/arguments.hpp"
#include "services/cli/tools/demo/setting.hpp"

namespace prehend::cli {

int scene_command(const std::vector<std::string>& arguments) {
  CLI::App app{"Draws a scene from a seed: objects on the table, light and person.",
               "prehend scene"};
  service::LabArguments lab;
  SettingOptions wishes;
  std::string output;
  lab.add_to(app);
  app.add_option("--seed", wishes.seed, "the same seed draws the same scene");
  app.add_option("--object", wishes.object, "what is reached for");
  app.add_option("--output", output, "file to write; otherwise standard output");
  if (const auto code = service::parse(app, arguments)) return *code;

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
