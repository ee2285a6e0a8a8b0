#pragma once

#include <prehend/model/scene.hpp>
#include <prehend/recognition/detector.hpp>
#include <prehend/recognition_rendering/renderer.hpp>
#include <prehend/recognition_rendering/training_views.hpp>

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
      *model::Catalogue::load(PREHEND_SOURCE "/common/models/objects/catalogue.toml");
  return made;
}

inline const Renderer& renderer() {
  static const Renderer made(catalogue());
  return made;
}

/// Models as the build makes them, from another seed; trained once a run.
inline const ObjectModels& trained() {
  static const ObjectModels made = [] {
    std::vector<TrainingClass> classes;
    for (const auto& object : catalogue().objects())
      classes.push_back({object.name, training_views(renderer(), object, CameraModel{}, 24, 5)});
    return *train(classes);
  }();
  return made;
}

}  // namespace prehend::recognition
