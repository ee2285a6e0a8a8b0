// `prehend objects detect` and `prehend objects evaluate`.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <prehend/base/log.hpp>
#include <prehend/base/paths.hpp>
#include <prehend/service/config.hpp>

#include "dataset.hpp"
#include "detector.hpp"
#include "model_file.hpp"
#include "picture_file.hpp"
#include "renderer.hpp"
#include "service.hpp"
#include "tool.hpp"

namespace prehend::recognition {
namespace {

using Json = nlohmann::ordered_json;

struct DetectArguments {
  std::vector<std::string> images, overrides;
  std::string model, config, scene, drawing;
  double accept = 0.5;
  bool json = false;
};

struct EvaluateArguments {
  std::string folder, model;
  double accept = 0.5;
  bool json = false, nearest_view = false;
};

int broken(const Error& error) {
  log::error("{}", error.message());
  return 3;
}

/// A picture of the calibrated camera shows the table; any other is looked at by itself.
std::vector<Sighting> look(const Detector& detector, const Picture& picture,
                           const CameraModel& camera) {
  if (picture.width == camera.width && picture.height == camera.height) {
    auto found = detector.on_table(picture, camera);
    if (found && !found->empty()) return *found;
  }
  const Picture small = shrink(picture, view_side);
  std::vector<Sighting> found = detector.in_picture(small);
  const double factor = static_cast<double>(picture.width) / small.width;
  for (Sighting& sighting : found) {
    sighting.box.x *= factor;
    sighting.box.y *= factor;
    sighting.box.width *= factor;
    sighting.box.height *= factor;
  }
  return found;
}

Json to_json(const Sighting& sighting) {
  Json made{{"name", sighting.name},
            {"probability", sighting.probability},
            {"shape", model::to_string(sighting.shape.kind)},
            {"size_m", nullptr},
            {"box_px", {sighting.box.x, sighting.box.y, sighting.box.width, sighting.box.height}}};
  if (model::is_valid(sighting.shape)) {
    const Eigen::Vector3d& size = sighting.shape.size;
    made["size_m"] = {size.x(), size.y(), size.z()};
  }
  if (sighting.at) {
    made["position_m"] = {sighting.at->x, sighting.at->y, model::half_extents(sighting.shape).z()};
    made["yaw_rad"] = sighting.at->yaw;
  }
  return made;
}

/// What the synthetic camera sees of a scene.
Expected<Picture> see(const std::string& file, const model::Catalogue& catalogue,
                      const CameraModel& camera) {
  const auto scene = model::load_scene(file, catalogue);
  if (!scene) return tl::unexpected(scene.error());
  return Renderer(catalogue).render(*scene, camera);
}

int detect(const DetectArguments& arguments) {
  if (arguments.images.empty() && arguments.scene.empty()) {
    log::error("nothing to look at (name pictures, or --scene FILE)");
    return 2;
  }
  const auto file = arguments.config.empty() ? share_directory() / "lab.toml"
                                             : std::filesystem::path(arguments.config);
  const auto config = service::Config::load(file, arguments.overrides);
  if (!config) return broken(config.error());
  const auto camera = configured_camera(*config);
  if (!camera) return broken(camera.error());
  const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
  if (!catalogue) return broken(catalogue.error());
  auto models = load_models(arguments.model.empty() ? config->path("recognition.model")
                                                    : std::filesystem::path(arguments.model));
  if (!models) return broken(models.error());
  DetectorOptions options;
  options.accept = arguments.accept;
  const Detector detector(std::move(*models), *catalogue, options);
  bool unreadable = false, any = false;
  std::vector<std::string> images = arguments.images;
  if (!arguments.scene.empty()) images.push_back(arguments.scene);
  for (const std::string& image : images) {
    auto picture = image == arguments.scene ? see(image, *catalogue, *camera) : load_picture(image);
    if (!picture) {
      log::error("{}", picture.error().message());
      unreadable = true;
      continue;
    }
    const std::vector<Sighting> found = look(detector, *picture, *camera);
    any = any || !found.empty();
    if (!arguments.drawing.empty()) {
      for (const Sighting& sighting : found)
        draw_frame(*picture, sighting.box.x, sighting.box.y, sighting.box.width,
                   sighting.box.height,
                   fmt::format("{} {:.0f} %", sighting.name, 100 * sighting.probability));
      if (const auto saved = save_jpeg(arguments.drawing, *picture); !saved)
        return broken(saved.error());
    }
    if (arguments.json) {
      Json objects = Json::array();
      for (const Sighting& sighting : found) objects.push_back(to_json(sighting));
      std::cout << Json{{"image", image}, {"objects", objects}} << "\n";
      continue;
    }
    fmt::print("{}{}\n", image, found.empty() ? ": nothing known" : "");
    for (const Sighting& sighting : found) {
      fmt::print("  {:24} {:5.1f} %", sighting.name, 100 * sighting.probability);
      if (sighting.at) fmt::print("  at {:.3f} {:.3f} m", sighting.at->x, sighting.at->y);
      fmt::print("\n");
    }
  }
  if (unreadable) return 3;
  return any ? 0 : 1;
}

struct Tally {
  int count = 0, correct = 0;
};

int evaluate(const EvaluateArguments& arguments) {
  const auto models = load_models(arguments.model);
  if (!models) return broken(models.error());
  const auto folders = class_folders(arguments.folder);
  if (!folders) return broken(folders.error());
  std::vector<std::pair<std::string, Tally>> classes;
  int accepted = 0, accepted_correct = 0;
  Tally all;
  for (const ClassFolder& folder : *folders) {
    Tally tally;
    for (const auto& file : folder.files) {
      const auto view = load_view(file);
      if (!view) {
        log::warning("left out: {}", view.error().message());
        continue;
      }
      const Classification seen =
          classify(*models, describe(*models, models->palette.quantise(view->picture), view->mask),
                   !arguments.nearest_view);
      const bool right = seen.best >= 0 &&
                         models->classes[static_cast<std::size_t>(seen.best)].name == folder.name;
      ++tally.count;
      tally.correct += right;
      if (seen.probability >= arguments.accept) {
        ++accepted;
        accepted_correct += right;
      }
    }
    all.count += tally.count;
    all.correct += tally.correct;
    classes.push_back({folder.name, tally});
  }
  if (all.count == 0) return broken({"no picture could be read", arguments.folder, ""});
  const double accuracy = static_cast<double>(all.correct) / all.count;
  const double share = static_cast<double>(accepted) / all.count;
  const double accuracy_accepted =
      accepted > 0 ? static_cast<double>(accepted_correct) / accepted : 0;
  if (arguments.json) {
    Json table = Json::object();
    for (const auto& [name, tally] : classes)
      table[name] = {{"count", tally.count}, {"correct", tally.correct}};
    std::cout << Json{{"count", all.count},
                      {"accuracy", accuracy},
                      {"accepted", share},
                      {"accuracy_accepted", accuracy_accepted},
                      {"classes", table}}
              << "\n";
    return 0;
  }
  for (const auto& [name, tally] : classes)
    fmt::print("{:32} {:4} of {:4}\n", name, tally.correct, tally.count);
  fmt::print("right {:.1f} % of {}; accepted {:.1f} %, of these right {:.1f} %\n", 100 * accuracy,
             all.count, 100 * share, 100 * accuracy_accepted);
  return 0;
}

}  // namespace

void add_detect(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DetectArguments>();
  CLI::App* command = app.add_subcommand("detect", "Names the objects in pictures.");
  auto* images = command->add_option("images", arguments->images, "picture files");
  command->add_option("--scene", arguments->scene, "a scene, seen by the synthetic camera")
      ->excludes(images);
  command->add_option("--draw", arguments->drawing, "jpeg with what was found drawn in");
  command->add_option("--model", arguments->model, "trained models; else those of lab.toml");
  command->add_option("--config", arguments->config, "lab.toml with the camera's calibration");
  command->add_option("--set", arguments->overrides, "table.key=value");
  command->add_option("--accept", arguments->accept, "least probability that is reported");
  command->add_flag("--json", arguments->json, "a JSON document a picture");
  command->callback([arguments, &exit_code] { exit_code = detect(*arguments); });
}

void add_evaluate(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "How often pictures in a folder a class are named rightly.");
  command->add_option("folder", arguments->folder, "holds a folder a class")->required();
  command->add_option("--model", arguments->model, "trained models")->required();
  command->add_option("--accept", arguments->accept, "least probability of an accepted answer");
  command->add_flag("--nearest-view", arguments->nearest_view,
                    "by the nearest view instead of the learned classifier");
  command->add_flag("--json", arguments->json, "one JSON document");
  command->callback([arguments, &exit_code] { exit_code = evaluate(*arguments); });
}

}  // namespace prehend::recognition
