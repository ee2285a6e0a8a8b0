#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <prehend/base/error.hpp>
#include <prehend/glove/frame.hpp>
#include <prehend/glove/joint_sensors.hpp>
#include <prehend/model/catalogue.hpp>
#include <prehend/model/scene.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "emulation.hpp"

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
  std::string port;  // a path, or host:port of datagrams
  int baud = 115200;
  std::vector<Site> sites = usual_sites();  // of a tracker's sensors, by address
  std::string format = "position_matrix";
  std::string mode = "stream";
  int range = 72;  // inches
  std::string hemisphere = "left";
  JointGains joint_gains;  // of a joint-angle glove; empty: not calibrated
  std::string wrist_port;  // of a tracker on the back of that glove; empty: none
  std::filesystem::path file;
  double rate = 30;   // Hz
  bool left = false;  // the hand that wears the glove
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

/// What a device hangs on.
enum class Line { none, serial, datagrams };

struct DeviceKind {
  std::string_view name;
  std::string_view help;
  Expected<std::unique_ptr<Device>> (*create)(const DeviceOptions& options) = nullptr;
  Line line = Line::none;
  /// Its other side, for tests and `prehend glove emulate`: whatever has a line needs one.
  std::unique_ptr<Emulator> (*emulate)(const DeviceOptions& options) = nullptr;
  /// Frames come by topic from elsewhere; the service must not publish them again.
  bool by_topic = false;
};

/// The one table of devices; a new one is a row in registry.cpp.
const std::vector<DeviceKind>& device_kinds();
Expected<DeviceKind> find_device(std::string_view name);

/// How to run the emulator of a kind that has one (see emulate()): a serial one on a
/// pseudo-terminal with this link at options.baud, or as a sender of datagrams to options.port.
EmulationOptions emulation_of(const DeviceKind& kind, const DeviceOptions& options,
                              const std::filesystem::path& link);

}  // namespace prehend::glove
