// `prehend objects render` and `prehend objects train`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "common/service/catalogue_argument.hpp"
#include "services/recognition/core/rendering/strangers.hpp"
#include "services/recognition/core/rendering/training_views.hpp"
#include "services/recognition/files/dataset.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/tools/objects/commands.hpp"
#include "services/recognition/tools/objects/descriptor_choice.hpp"

namespace prehend::recognition {
namespace {

struct RenderArguments {
  service::CatalogueArgument catalogue;
  std::string folder;
  std::uint64_t seed = 1;
  int views = 36, others = 0;
  bool json = false;
};

struct TrainArguments {
  std::string folder, others, model;
  DescriptorChoice choice;
  bool json = false;
};

int render(const RenderArguments& arguments) {
  const auto file = arguments.catalogue.path();
  if (!file) return broken(file.error());
  const auto catalogue = model::Catalogue::load(*file);
  if (!catalogue) return broken(catalogue.error());
  // Other things than the trials' strangers (trial_scenes.hpp), or they would be known.
  const auto objects = arguments.others > 0 ? strangers(arguments.others, 9000 + arguments.seed)
                                            : catalogue->objects();
  const Renderer renderer(objects);
  std::size_t written = 0, done = 0;
  Progress progress("rendering");
  for (const model::CatalogueObject& object : objects) {
    const auto folder = std::filesystem::path(arguments.folder) / object.name;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return broken({error.message(), folder.string(), "is the place writable?"});
    const auto views =
        training_views(renderer, object, CameraModel{}, arguments.views, arguments.seed);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::string name = fmt::format("view_{:03}", i);
      // As jpeg, like everything that comes from a camera.
      for (const auto& saved : {save_jpeg(folder / (name + ".jpg"), views[i].picture),
                                save_png(folder / (name + ".mask.png"), views[i].mask)})
        if (!saved) return broken(saved.error());
      ++written;
    }
    progress.show(++done, objects.size());
  }
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"classes", objects.size()}, {"views", written}} << "\n";
  else
    to_terminal("{} views of {} objects in {}\n", written, objects.size(), arguments.folder);
  return 0;
}

int train_models(const TrainArguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  const auto dataset = load_dataset(arguments.folder);
  if (!dataset) return broken(dataset.error());
  for (const Error& error : dataset->left_out) log::warning("left out: {}", error.message());
  for (const TrainingClass& c : dataset->classes)
    if (c.views.empty())
      log::warning("class {} has no picture that can be read", c.name);
    else if (c.views.size() < 3)
      log::warning("class {} has {} picture(s): how sure an answer is cannot be judged well",
                   c.name, c.views.size());
  if (dataset->classes.size() == 1 && arguments.others.empty())
    log::warning(
        "{} is the only class: whatever is shown is taken for it (add a class, or --others)",
        dataset->classes.front().name);
  const auto options = arguments.choice.options(*dataset);
  if (!options) {
    log::error(options.error());
    return 2;
  }
  Dataset others;
  if (!arguments.others.empty()) {
    auto read = load_dataset(arguments.others);
    if (!read) return broken(read.error());
    others = std::move(*read);
    for (const Error& error : others.left_out) log::warning("left out: {}", error.message());
  }
  const auto models = train(dataset->classes, *options, 60, others.classes);
  if (!models) return broken(models.error());
  if (const auto saved = save_models(arguments.model, *models); !saved)
    return broken(saved.error());
  std::size_t views = 0;
  for (const TrainingClass& c : dataset->classes) views += c.views.size();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"classes", models->classes.size()},
                                        {"views", views},
                                        {"seconds", seconds}}
              << "\n";
  else
    to_terminal("{} classes from {} views in {:.1f} s: {}\n", models->classes.size(), views,
                seconds, arguments.model);
  return 0;
}

}  // namespace

void add_render(tool::Program& program) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = program.app().add_subcommand(
      "render", "Draws labelled training views of the catalogue's objects, a folder each.");
  command->add_option("folder", arguments->folder, "where to")->required();
  command->add_option("--seed", arguments->seed, "draws light, place and background");
  command->add_option("--views", arguments->views, "views an object")->check(CLI::Range(1, 10000));
  arguments->catalogue.add_to(*command);
  command
      ->add_option("--others", arguments->others,
                   "draws so many things that are none of them instead")
      ->check(CLI::Range(0, 10000));
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return render(*arguments); });
}

void add_train(tool::Program& program) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = program.app().add_subcommand(
      "train", "Learns object models from a folder of pictures a class.");
  command->add_option("folder", arguments->folder, "holds a folder a class")->required();
  command->add_option("--model", arguments->model, "file to write")->required();
  command->add_option("--others", arguments->others,
                      "a folder of the same kind: things that are none of them");
  arguments->choice.add_to(*command);
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return train_models(*arguments); });
}

}  // namespace prehend::recognition
