#pragma once

#include "services/recognition/cameras/camera.hpp"

namespace prehend::recognition {

/// A V4L2 device («/dev/video0» or «0»).
Expected<std::unique_ptr<Camera>> open_device(const CameraOptions& options);
/// A video file or the address of a stream.
Expected<std::unique_ptr<Camera>> open_video(const CameraOptions& options);
/// The pictures of a folder in the order of their names, over and over.
Expected<std::unique_ptr<Camera>> open_folder(const CameraOptions& options);
/// A node of ROS 2: options.path is the topic of its compressed pictures.
Expected<std::unique_ptr<Camera>> open_nodes(const CameraOptions& options);
/// A rendered scene. The light that reaches the sensor is computed once, its noise every time.
std::unique_ptr<Camera> make_synthetic(const CameraOptions& options,
                                       const model::Catalogue& catalogue,
                                       const model::Scene& scene);

}  // namespace prehend::recognition
