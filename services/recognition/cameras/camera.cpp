#include "camera.hpp"

#include "sources.hpp"

namespace prehend::recognition {

Expected<std::unique_ptr<Camera>> open_camera(const CameraOptions& options,
                                              const model::Catalogue& catalogue,
                                              const model::Scene* scene) {
  if (options.source == "device") return open_device(options);
  if (options.source == "video") return open_video(options);
  if (options.source == "folder") return open_folder(options);
  if (options.source == "synthetic") {
    if (!scene)
      return fail("the synthetic camera has no scene to show", "recognition.source",
                  "set lab.scene to a scene file");
    return make_synthetic(options, catalogue, *scene);
  }
  return fail("unknown source '" + options.source + "'", "recognition.source",
              "topic, device, video, folder or synthetic");
}

}  // namespace prehend::recognition
