#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"
#include "common/base/time.hpp"
#include "common/model/scene.hpp"
#include "services/recognition/core/geometry/camera_model.hpp"
#include "services/recognition/core/picture/picture.hpp"

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
  std::string source;  // a name of camera_kinds()
  std::string path;    // device file or number, video file or address, folder, topic of ROS 2
  CameraModel model;   // wanted size; for a synthetic one: the calibration
  double rate = 10;    // Hz, asked of a device; of a file's pictures those between are left out
  std::string network = "laptop";  // how nodes of ROS 2 are reached: laptop or lan
};

/// Where pictures come from.
enum class CameraLine {
  none,    // computed here
  device,  // recognition.path is a device file or its number; empty: the first
  stream,  // recognition.path is a file or an address
  folder,  // recognition.path is a folder of pictures
  nodes,   // recognition.path is a topic of ROS 2
  topic    // others publish them on camera/image; there is nothing to open
};
/// As `prehend camera sources` says it.
inline constexpr auto camera_line_names = named_values<CameraLine>({{CameraLine::none, "none"},
                                                                    {CameraLine::device, "device"},
                                                                    {CameraLine::stream, "stream"},
                                                                    {CameraLine::folder, "folder"},
                                                                    {CameraLine::nodes, "nodes"},
                                                                    {CameraLine::topic, "topic"}});

/// Everything that others may want to know of a kind of camera. Nothing outside this folder names
/// one: the service, its tools and `prehend demo` ask the row.
struct CameraKind {
  std::string_view name;  // as in recognition.source
  std::string_view help;
  CameraLine line = CameraLine::none;
  /// Opens it; none: pictures come by topic. `scene` may be missing.
  Expected<std::unique_ptr<Camera>> (*open)(const CameraOptions& options,
                                            const model::Catalogue& catalogue,
                                            const model::Scene* scene) = nullptr;
  /// It shows lab.scene, so what stands there is known exactly.
  bool synthetic = false;
};

/// The one table of cameras; a new one is a row in camera.cpp. The first is what a lab has that
/// names none.
const std::vector<CameraKind>& camera_kinds();
/// An empty name is the first of the table.
Expected<CameraKind> find_camera(std::string_view name);
/// The one that takes pictures from camera/image.
const CameraKind& topic_camera();
/// «device[:PATH], video:PATH, folder:PATH or ros2[:TOPIC]»: those of the lines that a command
/// accepts.
std::string camera_words(const std::vector<CameraLine>& lines);

/// What is before and after the colon of KIND[:PATH].
struct CameraSource {
  std::string kind, path;
};
CameraSource camera_source(const std::string& text);

/// The scene and the catalogue are used by a synthetic one only.
Expected<std::unique_ptr<Camera>> open_camera(const CameraOptions& options,
                                              const model::Catalogue& catalogue,
                                              const model::Scene* scene);

}  // namespace prehend::recognition
