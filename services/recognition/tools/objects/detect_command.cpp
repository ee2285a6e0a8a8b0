// `prehend objects detect`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/paths.hpp"
#include "common/base/to_terminal.hpp"
#include "common/service/config.hpp"
#include "services/recognition/core/detection/detector.hpp"
#include "services/recognition/core/learning/answer.hpp"
#include "services/recognition/core/rendering/renderer.hpp"
#include "services/recognition/files/dataset.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/service/service.hpp"
#include "services/recognition/tools/objects/commands.hpp"

namespace prehend::recognition {
namespace {

using Json = nlohmann::ordered_json;

struct DetectArguments {
  std::vector<std::string> images, overrides;
  std::string model, config, scene, drawing;
  double accept = 0.5;
  bool json = false;
};

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

/// Where no object was found: is there something unknown, or nothing?
PhotoVerdict verdict_of(const Detector& detector, const Picture& picture,
                        const std::vector<Sighting>& found) {
  if (!found.empty()) return found.size() > 1 ? PhotoVerdict::two_objects : PhotoVerdict::object;
  const PhotoAnswer whole =
      answer(detector.models(), shrink(picture, view_side), detector.options().accept);
  return whole.verdict == PhotoVerdict::nothing ? PhotoVerdict::nothing : PhotoVerdict::unknown;
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
    made["outline"] = {{"agreement", sighting.agreement}, {"contrast", sighting.contrast}};
    made["size_seen"] = {sighting.measured.x(), sighting.measured.y()};  // shares of size_m
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
      log::error(picture.error());
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
      std::cout << Json{{"image", image},
                        {"objects", objects},
                        {"verdict", to_string(verdict_of(detector, *picture, found))}}
                << "\n";
      continue;
    }
    to_terminal("{}: {}\n", image, to_string(verdict_of(detector, *picture, found)));
    for (const Sighting& sighting : found) {
      to_terminal("  {:24} {:5.1f} %", sighting.name, 100 * sighting.probability);
      if (sighting.at) to_terminal("  at {:.3f} {:.3f} m", sighting.at->x, sighting.at->y);
      to_terminal("\n");
    }
  }
  if (unreadable) return 3;
  return any ? 0 : 1;
}

}  // namespace

void add_detect(tool::Program& program) {
  auto arguments = std::make_shared<DetectArguments>();
  CLI::App* command = program.app().add_subcommand("detect", "Names the objects in pictures.");
  auto* images = command->add_option("images", arguments->images, "picture files");
  command->add_option("--scene", arguments->scene, "a scene, seen by the synthetic camera")
      ->excludes(images);
  command->add_option("--draw", arguments->drawing, "jpeg with what was found drawn in");
  command->add_option("--model", arguments->model, "trained models; else those of lab.toml");
  command->add_option("--config", arguments->config, "lab.toml with the camera's calibration");
  command->add_option("--set", arguments->overrides, "table.key=value");
  command->add_option("--accept", arguments->accept, "least probability that is reported");
  command->add_flag("--json", arguments->json, "a JSON document a picture");
  program.on(*command, [arguments] { return detect(*arguments); });
}

}  // namespace prehend::recognition
