#pragma once

#include "common/model/scene.hpp"
#include "services/recognition/core/detection/detector.hpp"
#include "services/recognition/core/rendering/renderer.hpp"
#include "services/recognition/core/rendering/strangers.hpp"
#include "services/recognition/core/rendering/training_views.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::recognition {

/// The lab's camera as config_keys.cpp has it.
inline CameraModel lab_camera() {
  CameraModel camera;
  camera.X_WC = make_pose({0, -0.75, 0.8},
                          Eigen::Quaterniond(0.36650123, -0.93041757, 0, 0).toRotationMatrix());
  return camera;
}

inline const model::Catalogue& catalogue() {
  static const model::Catalogue made =
      *model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  return made;
}

inline const Renderer& renderer() {
  static const Renderer made(catalogue());
  return made;
}

/// As they come back from the jpegs that the build learns from.
inline std::vector<TrainingView> through_jpeg(std::vector<TrainingView> views) {
  for (TrainingView& view : views)
    view.picture = decode_picture(encode_jpeg(view.picture), "view").value();
  return views;
}

/// Models as the build makes them, from another seed; trained once a run.
inline const ObjectModels& trained() {
  static const ObjectModels made = [] {
    std::vector<TrainingClass> classes, others;
    const auto views = [](const Renderer& draws, const model::CatalogueObject& object, int count) {
      return through_jpeg(training_views(draws, object, CameraModel{}, count, 5));
    };
    for (const auto& object : catalogue().objects())
      classes.push_back({object.name, views(renderer(), object, 36)});
    const auto unknown = strangers(100, 9005);
    const Renderer unknown_renderer(unknown);
    for (const auto& thing : unknown)
      others.push_back({thing.name, views(unknown_renderer, thing, 4)});
    return *train(classes, {}, 60, others);
  }();
  return made;
}

}  // namespace prehend::recognition
