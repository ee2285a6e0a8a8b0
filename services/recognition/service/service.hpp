#pragma once

#include <memory>

#include "common/service/shell.hpp"
#include "services/recognition/core/geometry/camera_model.hpp"

namespace prehend::recognition {

/// The calibration in [camera] of lab.toml.
Expected<CameraModel> configured_camera(const service::Config& config);

/// Pictures of the camera, or of the topic, in; detections out.
class Service {
 public:
  static Expected<std::unique_ptr<Service>> create(service::Shell& shell);
  ~Service();

 private:
  class Topics;
  class CameraThread;
  explicit Service(std::unique_ptr<Topics> topics);

  std::unique_ptr<Topics> topics_;
  std::unique_ptr<CameraThread> camera_;  // last: its thread uses the rest. Null: by topic
};

}  // namespace prehend::recognition
