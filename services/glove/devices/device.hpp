#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <prehend/base/error.hpp>
#include <prehend/glove/frame.hpp>
#include <prehend/model/catalogue.hpp>
#include <prehend/model/scene.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "emulator.hpp"

namespace prehend::glove {

/// What a device tells the service. All of it may be called from the device's thread.
struct DeviceSink {
  std::function<void(Frame)> frame;
  /// Something is missing; one line that says what, and what to do. Said once when it changes.
  std::function<void(std::string)> degraded;
  std::function<void(std::string_view reason, std::uint64_t count)> drop;
};

/// Everything a device may need; each takes what concerns it.
struct DeviceOptions {
  Pose X_WT = Pose::Identity();
  std::string port;
  int baud = 115200;
  std::vector<Site> sites = usual_sites();  // of a tracker's sensors, by address
  std::string format = "position_matrix";
  std::string mode = "stream";
  int range = 72;  // inches
  std::string hemisphere = "left";
  std::filesystem::path file;
  double rate = 30;  // Hz
  double hand_scale = 1;
  model::Scene scene;
  model::Catalogue catalogue;
};

/// A source of glove frames in real time. Made by find_device(...)->create, which fails where the
/// configuration is wrong; what may come and go (a port) is only reported as degraded.
class Device {
 public:
  virtual ~Device() = default;  // ends its thread
  /// Begins to deliver. Called once.
  virtual void start(DeviceSink sink) = 0;
};

struct DeviceKind {
  std::string_view name;
  std::string_view help;
  /// Frames come by topic from elsewhere; the service must not publish them again.
  bool by_topic = false;
  Expected<std::unique_ptr<Device>> (*create)(const DeviceOptions& options) = nullptr;
  /// The other side of its line, for tests and `prehend glove emulate`; null where there is no
  /// line.
  std::unique_ptr<Emulator> (*emulate)(const DeviceOptions& options) = nullptr;
};

/// The one table of devices; a new one is a row in registry.cpp.
const std::vector<DeviceKind>& device_kinds();
Expected<DeviceKind> find_device(std::string_view name);

}  // namespace prehend::glove
