#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/scene.hpp"
#include "services/glove/core/feedback.hpp"
#include "services/glove/core/frame.hpp"
#include "services/glove/core/frame_source.hpp"
#include "services/glove/core/joint_sensors.hpp"
#include "services/glove/devices/emulation.hpp"

namespace prehend::glove {

/// What a device tells the service. All of it may be called from the device's thread.
struct DeviceSink {
  std::function<void(Frame)> frame;
  /// Something is missing; one line that says what, and what to do. Said once when it changes.
  std::function<void(std::string)> degraded;
  std::function<void(std::string_view reason, std::uint64_t count)> drop;
  /// The wearer begins to feel what was felt then; empty: nobody asks.
  std::function<void(Time stamp)> felt{};
};

/// Everything a device may need; each takes what concerns it.
struct DeviceOptions {
  Pose X_WT = Pose::Identity();             // where the tracker stands on the table
  std::string port;                         // a path, host:port of datagrams, topic of ROS 2
  std::string network = "laptop";           // where its nodes are: laptop or lan
  std::vector<std::string> senders;         // of datagrams, by address; empty: on this machine
  std::string token;                        // before each of them; empty: none
  bool secured = false;                     // the lab has keys
  int baud = 115200;                        // bits per second on that port
  std::vector<Site> sites = usual_sites();  // of a tracker's sensors, by address
  std::string format = "position_matrix";   // of the records that the tracker is asked for
  std::string mode = "stream";              // or point: the tracker is asked for each frame
  int range = 72;                           // inches, of the tracker: 36, 72 or 144
  std::string hemisphere = "left";          // side of the transmitter where the hand is
  bool buttons = false;                     // the tracker has a mouse whose buttons are told
  JointGains joint_gains;                   // of a joint-angle glove; empty: not calibrated
  std::string wrist_port;                   // of a tracker on the back of that glove; empty: none
  std::filesystem::path file;               // recording to play
  double rate = 30;                         // Hz, of what measures when it is asked
  std::uint64_t seed = 0;                   // of a synthetic hand's noise, beside the scene's own
  bool left = false;                        // the hand that wears the glove
  double feedback_force = 0;                // N, that holds a finger back with all it has; 0: none
  double hand_scale = 1;                    // length of the user's hand, 1: of an average adult
  model::Scene scene;                       // what a computed hand reaches for
  model::Catalogue catalogue;               // the objects in it
};

/// A source of glove frames in real time. Made by find_device(...)->create, which fails where the
/// configuration is wrong; what may come and go (a port) is only reported as degraded.
class Device {
 public:
  virtual ~Device() = default;  // ends its thread
  /// Begins to deliver. Called once.
  virtual void start(DeviceSink sink) = 0;
  /// What the wearer is to feel for feedback_holds, of a kind that can (DeviceKind::feels). From
  /// any thread; does not wait.
  virtual void feel(const Feedback&) {}
};

/// Where frames come from.
enum class Line {
  none,       // computed here
  serial,     // glove.port is the path of a serial port
  datagrams,  // glove.port is host:port where they come
  nodes,      // glove.port is a topic of ROS 2
  topic,      // others publish them on glove/frame; the service must not publish them again
  file        // glove.file is played once
};
/// As `prehend glove devices` says it.
inline constexpr auto line_names = named_values<Line>({{Line::none, "none"},
                                                       {Line::serial, "serial"},
                                                       {Line::datagrams, "udp"},
                                                       {Line::nodes, "nodes"},
                                                       {Line::topic, "topic"},
                                                       {Line::file, "file"}});

/// Everything that others may want to know of a kind of device. Nothing outside this folder names
/// one: the service, its tools and `prehend demo` ask the row.
struct DeviceKind {
  std::string_view name;  // as in glove.device
  std::string_view help;
  Expected<std::unique_ptr<Device>> (*create)(const DeviceOptions& options) = nullptr;
  Line line = Line::none;
  /// Its other side, for tests and `prehend glove emulate`: whatever has a port needs one.
  std::unique_ptr<Emulator> (*emulate)(const DeviceOptions& options) = nullptr;
  /// What has no port: the hand itself, which can also move an emulated device (--from).
  Expected<std::unique_ptr<FrameSource>> (*source)(const DeviceOptions& options) = nullptr;
  /// Datagrams: where they come unless glove.port says otherwise.
  std::string_view address{};
  /// It is the hand of the scene's demonstrator, whose measures are known: nobody calibrates it.
  bool synthetic = false;
  /// It can hold fingers back.
  bool feels = false;
  /// The kind of tracker on its back, at glove.wrist_port, that says where the hand is, since the
  /// device itself measures only joints; empty: it tracks the hand.
  std::string_view tracker{};
  /// The keys of lab.toml that concern it, beside those of every glove.
  std::vector<std::string_view> keys{};

  bool has_port() const {
    return line == Line::serial || line == Line::datagrams || line == Line::nodes;
  }
};

/// The one table of devices; a new one is a row in registry.cpp. The first is what a lab has that
/// names none; the first with an emulator is what `prehend demo` plays on.
const std::vector<DeviceKind>& device_kinds();
/// An empty name is the first of the table.
Expected<DeviceKind> find_device(std::string_view name);
/// The one that takes frames from glove/frame.
const DeviceKind& topic_device();

/// How to run the emulator of a kind that has one (see emulate()): a serial one on a
/// pseudo-terminal with this link at options.baud, or as a sender of datagrams to options.port.
EmulationOptions emulation_of(const DeviceKind& kind, const DeviceOptions& options,
                              const std::filesystem::path& link);

}  // namespace prehend::glove
