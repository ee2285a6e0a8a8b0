#pragma once

#include <prehend/recognition_geometry/camera_model.hpp>
#include <prehend/service/shell.hpp>

namespace prehend::recognition {

/// The calibration in [camera] of lab.toml.
Expected<CameraModel> configured_camera(const service::Config& config);

/// Runs recognition in a shell until it is stopped; returns the exit code of the process.
int run_service(service::Shell& shell);

}  // namespace prehend::recognition
