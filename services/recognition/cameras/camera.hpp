#pragma once

#include <memory>
#include <prehend/base/error.hpp>
#include <prehend/base/time.hpp>
#include <prehend/model/scene.hpp>
#include <prehend/recognition_geometry/camera_model.hpp>
#include <prehend/recognition_picture/picture.hpp>
#include <string>

namespace prehend::recognition {

/// A source of pictures. Used by one thread; `next` may block for as long as an exposure takes.
class Camera {
 public:
  virtual ~Camera() = default;
  /// The next picture, or why there is none now; calling again tries again (a camera that was
  /// unplugged is opened anew).
  virtual Expected<Picture> next() = 0;
  /// True once there will be no more pictures, ever: a file has been played.
  virtual bool finished() const { return false; }
  /// The last picture arrived at a pace of its own, so the caller need not wait.
  virtual bool paces_itself() const { return false; }
  /// How long before `next` returned the last picture was exposed, as far as the camera tells.
  virtual Duration age() const { return {}; }
};

struct CameraOptions {
  std::string source;  // device, video, folder or synthetic
  std::string path;    // device file or number, video file or address, folder
  CameraModel model;   // wanted size; for synthetic: the calibration
  double rate = 10;    // Hz, asked of a device; of a file's pictures those between are left out
};

/// The scene and the catalogue are used by `synthetic` only.
Expected<std::unique_ptr<Camera>> open_camera(const CameraOptions& options,
                                              const model::Catalogue& catalogue,
                                              const model::Scene* scene);

}  // namespace prehend::recognition
