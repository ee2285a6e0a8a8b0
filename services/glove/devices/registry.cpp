#include <algorithm>

#include "common/base/log.hpp"
#include "common/serial/pseudo_terminal.hpp"
#include "services/glove/core/carrying_hand.hpp"
#include "services/glove/core/synthetic_hand.hpp"
#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/devices/joint_glove.hpp"
#include "services/glove/devices/landmarks.hpp"
#include "services/glove/devices/nest_of_birds.hpp"
#include "services/glove/devices/node_hand.hpp"
#include "services/glove/devices/open_glove.hpp"
#include "services/glove/devices/paced.hpp"
#include "services/glove/files/hand_recording.hpp"

namespace prehend::glove {
namespace {

/// Frames arrive on glove/frame; there is nothing to drive.
class TopicDevice final : public Device {
 public:
  void start(DeviceSink) override {}
};

Expected<std::unique_ptr<Device>> create_topic(const DeviceOptions&) {
  return std::make_unique<TopicDevice>();
}

Expected<std::unique_ptr<FrameSource>> synthetic_source(const DeviceOptions& options) {
  const auto made = [](auto hand) -> Expected<std::unique_ptr<FrameSource>> {
    if (!hand) return tl::unexpected(hand.error());
    return std::make_unique<typename decltype(hand)::value_type>(std::move(*hand));
  };
  const SyntheticOptions all{
      .X_WT = options.X_WT, .rate = options.rate, .seed = options.seed, .left = options.left};
  if (!options.scene.demonstrator.carry_W.isZero())
    return made(CarryingHand::create(options.scene, options.catalogue, all));
  return made(SyntheticHand::create(options.scene, options.catalogue, all));
}

Expected<std::unique_ptr<Device>> create_synthetic(const DeviceOptions& options) {
  auto hand = synthetic_source(options);
  if (!hand) return tl::unexpected(hand.error());
  return std::make_unique<PacedDevice>(std::move(*hand), PacedOptions{.rate = options.rate});
}

Expected<Recording> load_recording(const DeviceOptions& options) {
  return Recording::load(options.file, {.X_WT = options.X_WT,
                                        .X_WH = options.scene.X_WH,
                                        .rate = options.scene.recording_rate,
                                        .hand_scale = options.hand_scale});
}

Expected<std::unique_ptr<FrameSource>> recording_source(const DeviceOptions& options) {
  auto recording = load_recording(options);
  if (!recording) return tl::unexpected(recording.error());
  return std::make_unique<Recording>(std::move(*recording));
}

Expected<std::unique_ptr<Device>> create_recording(const DeviceOptions& options) {
  auto recording = load_recording(options);
  if (!recording) return tl::unexpected(recording.error());
  log::info("{}: {} frames{}", options.file.string(), recording->size(),
            recording->left() ? " of a left hand, mirrored into a right one" : "");
  if (const std::string told = recording->left_out(); !told.empty())
    log::warning("{}: left out: {}", options.file.string(), told);
  for (const std::string& remark : recording->remarks())
    log::warning("{}: {}", options.file.string(), remark);
  PacedOptions paced{.every_frame = true,
                     .at_end = "the recording has ended; the hand stays as it is"};
  return std::make_unique<PacedDevice>(std::make_unique<Recording>(std::move(*recording)),
                                       std::move(paced));
}

}  // namespace

const std::vector<DeviceKind>& device_kinds() {
  static const std::vector<DeviceKind> kinds{
      {.name = "synthetic",
       .help = "a computed hand that grasps the scene's object",
       .create = create_synthetic,
       .source = synthetic_source,
       .synthetic = true,
       .keys = {"glove.rate"}},
      {.name = "nest_of_birds",
       .help = "magnetic sensors on a serial port",
       .create = create_nest_of_birds,
       .line = Line::serial,
       .emulate = emulate_nest_of_birds,
       .keys = {"glove.port", "glove.baud", "glove.sites", "glove.format", "glove.mode",
                "glove.range", "glove.hemisphere", "glove.buttons", "glove.rate"}},
      {.name = "joint_glove",
       .help = "a glove that measures joint angles, on a serial port",
       .create = create_joint_glove,
       .line = Line::serial,
       .emulate = emulate_joint_glove,
       .tracker = "nest_of_birds",
       .keys = {"glove.port", "glove.baud", "glove.rate", "glove.wrist_port"}},
      {.name = "open_glove",
       .help = "an open glove that bends with each finger (LucidGloves), on a serial port",
       .create = create_open_glove,
       .line = Line::serial,
       .emulate = emulate_open_glove,
       .feels = true,
       .tracker = "nest_of_birds",
       .keys = {"glove.port", "glove.baud", "glove.wrist_port", "glove.feedback_force"}},
      {.name = "landmarks",
       .help = "a bare hand that a camera sees, as datagrams",
       .create = create_landmarks,
       .line = Line::datagrams,
       .emulate = emulate_landmarks,
       .address = landmarks_address,
       .keys = {"glove.port", "glove.senders", "glove.token_file"}},
      {.name = "ros2",
       .help = "a bare hand that a node of ROS 2 tracks, as PoseArray",
       .create = create_node_hand,
       .line = Line::nodes,
       .emulate = emulate_node_hand,
       .keys = {"glove.port", "ros.network"}},
      {.name = "recording",
       .help = "a hand recording, Leap or 21 landmarks",
       .create = create_recording,
       .line = Line::file,
       .source = recording_source,
       .keys = {"glove.file"}},
      {.name = "topic",
       .help = "frames that others publish on glove/frame",
       .create = create_topic,
       .line = Line::topic},
  };
  return kinds;
}

Expected<DeviceKind> find_device(std::string_view name) {
  if (name.empty()) return device_kinds().front();
  std::string known;
  for (const DeviceKind& kind : device_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  return fail("there is no device '" + std::string(name) + "'", "glove.device",
              "choose one of " + known);
}

const DeviceKind& topic_device() {
  return *std::find_if(device_kinds().begin(), device_kinds().end(),
                       [](const DeviceKind& kind) { return kind.line == Line::topic; });
}

EmulationOptions emulation_of(const DeviceKind& kind, const DeviceOptions& options,
                              const std::filesystem::path& link) {
  EmulationOptions made;
  made.device = [kind, options] { return kind.emulate(options); };
  if (kind.line == Line::datagrams) {
    const std::string address = options.port.empty() ? std::string(kind.address) : options.port;
    made.plug_in = [address, token = options.token]() -> Expected<std::unique_ptr<serial::Plug>> {
      auto sender = DatagramSender::create(address, token);
      if (!sender) return tl::unexpected(sender.error());
      return std::make_unique<DatagramSender>(std::move(*sender));
    };
  } else if (kind.line == Line::nodes) {
    made.plug_in = [options] { return plug_into_node_hand(options); };
  } else {
    made.baud = options.baud;
    made.plug_in = [link]() -> Expected<std::unique_ptr<serial::Plug>> {
      auto terminal = serial::PseudoTerminal::open(link);
      if (!terminal) return tl::unexpected(terminal.error());
      return std::make_unique<serial::PseudoTerminal>(std::move(*terminal));
    };
  }
  return made;
}

}  // namespace prehend::glove
