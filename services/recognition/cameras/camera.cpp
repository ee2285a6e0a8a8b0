#include "services/recognition/cameras/camera.hpp"

#include <algorithm>

#include "services/recognition/cameras/sources.hpp"

namespace prehend::recognition {
namespace {

Expected<std::unique_ptr<Camera>> open_synthetic(const CameraOptions& options,
                                                 const model::Catalogue& catalogue,
                                                 const model::Scene* scene) {
  if (!scene)
    return fail("the synthetic camera has no scene to show", "recognition.source",
                "set lab.scene to a scene file");
  return make_synthetic(options, catalogue, *scene);
}

/// One that shows what is there, whatever the scene.
template <Expected<std::unique_ptr<Camera>> (*open)(const CameraOptions&)>
Expected<std::unique_ptr<Camera>> open_real(const CameraOptions& options, const model::Catalogue&,
                                            const model::Scene*) {
  return open(options);
}

}  // namespace

const std::vector<CameraKind>& camera_kinds() {
  static const std::vector<CameraKind> kinds{
      {.name = "synthetic",
       .help = "the scene, rendered as a camera would see it",
       .open = open_synthetic,
       .synthetic = true},
      {.name = "device",
       .help = "a camera of this machine",
       .line = CameraLine::device,
       .open = open_real<open_device>},
      {.name = "video",
       .help = "a video file, or the address of a stream",
       .line = CameraLine::stream,
       .open = open_real<open_video>},
      {.name = "folder",
       .help = "the pictures of a folder, over and over",
       .line = CameraLine::folder,
       .open = open_real<open_folder>},
      {.name = "ros2",
       .help = "a camera that is a node of ROS 2",
       .line = CameraLine::nodes,
       .open = open_real<open_nodes>},
      {.name = "topic",
       .help = "pictures that others publish on camera/image",
       .line = CameraLine::topic},
  };
  return kinds;
}

Expected<CameraKind> find_camera(std::string_view name) {
  if (name.empty()) return camera_kinds().front();
  std::string known;
  for (const CameraKind& kind : camera_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  return fail("unknown source '" + std::string(name) + "'", "recognition.source",
              "choose one of " + known);
}

const CameraKind& topic_camera() {
  return *std::find_if(camera_kinds().begin(), camera_kinds().end(),
                       [](const CameraKind& kind) { return kind.line == CameraLine::topic; });
}

std::string camera_words(const std::vector<CameraLine>& lines) {
  std::string text;
  for (const CameraKind& kind : camera_kinds()) {
    if (std::find(lines.begin(), lines.end(), kind.line) == lines.end()) continue;
    text += (text.empty() ? "" : ", ") + std::string(kind.name);
    if (kind.line == CameraLine::device) text += "[:PATH]";
    if (kind.line == CameraLine::nodes) text += "[:TOPIC]";
    if (kind.line == CameraLine::stream || kind.line == CameraLine::folder) text += ":PATH";
  }
  return text;
}

CameraSource camera_source(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

Expected<std::unique_ptr<Camera>> open_camera(const CameraOptions& options,
                                              const model::Catalogue& catalogue,
                                              const model::Scene* scene) {
  const auto kind = find_camera(options.source);
  if (!kind) return tl::unexpected(kind.error());
  if (!kind->open)
    return fail("there is nothing to open", "recognition.source", "its pictures come by topic");
  return kind->open(options, catalogue, scene);
}

}  // namespace prehend::recognition
