#include <prehend/base/log.hpp>
#include <prehend/glove/recording.hpp>
#include <prehend/glove/synthetic_hand.hpp>

#include "datagrams.hpp"
#include "device.hpp"
#include "joint_glove.hpp"
#include "landmarks.hpp"
#include "nest_of_birds.hpp"
#include "paced.hpp"
#include "pseudo_terminal.hpp"

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

Expected<std::unique_ptr<Device>> create_synthetic(const DeviceOptions& options) {
  auto hand = SyntheticHand::create(options.scene, options.catalogue,
                                    {.X_WT = options.X_WT, .rate = options.rate});
  if (!hand) return tl::unexpected(hand.error());
  return std::make_unique<PacedDevice>(std::make_unique<SyntheticHand>(std::move(*hand)),
                                       PacedOptions{.rate = options.rate});
}

Expected<std::unique_ptr<Device>> create_recording(const DeviceOptions& options) {
  auto recording = Recording::load(options.file, {.X_WT = options.X_WT,
                                                  .X_WH = options.scene.X_WH,
                                                  .rate = options.scene.recording_rate,
                                                  .hand_scale = options.hand_scale});
  if (!recording) return tl::unexpected(recording.error());
  log::info("{}: {} frames{}", options.file.string(), recording->size(),
            recording->left() ? " of a left hand, mirrored into a right one" : "");
  if (recording->unreadable() > 0)
    log::warning("{}: {} rows say nothing usable", options.file.string(), recording->unreadable());
  if (recording->other_hand() > 0)
    log::info("{}: {} rows of the left hand left out", options.file.string(),
              recording->other_hand());
  PacedOptions paced{.every_frame = true,
                     .at_end = "the recording has ended; the hand stays as it is"};
  return std::make_unique<PacedDevice>(std::make_unique<Recording>(std::move(*recording)),
                                       std::move(paced));
}

}  // namespace

const std::vector<DeviceKind>& device_kinds() {
  static const std::vector<DeviceKind> kinds{
      {.name = "topic",
       .help = "frames that others publish on glove/frame",
       .create = create_topic,
       .by_topic = true},
      {.name = "nest_of_birds",
       .help = "magnetic sensors on a serial port",
       .create = create_nest_of_birds,
       .line = Line::serial,
       .emulate = emulate_nest_of_birds},
      {.name = "joint_glove",
       .help = "a glove that measures joint angles, on a serial port",
       .create = create_joint_glove,
       .line = Line::serial,
       .emulate = emulate_joint_glove},
      {.name = "landmarks",
       .help = "a bare hand that a camera sees, as datagrams",
       .create = create_landmarks,
       .line = Line::datagrams,
       .emulate = emulate_landmarks},
      {.name = "recording",
       .help = "a hand recording, Leap or 21 landmarks",
       .create = create_recording},
      {.name = "synthetic",
       .help = "a computed hand that grasps the scene's object",
       .create = create_synthetic},
  };
  return kinds;
}

Expected<DeviceKind> find_device(std::string_view name) {
  std::string known;
  for (const DeviceKind& kind : device_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  return fail("there is no device '" + std::string(name) + "'", "glove.device",
              "choose one of " + known);
}

EmulationOptions emulation_of(const DeviceKind& kind, const DeviceOptions& options,
                              const std::filesystem::path& link) {
  EmulationOptions made;
  made.device = [kind, options] { return kind.emulate(options); };
  if (kind.line == Line::datagrams) {
    made.plug_in = [options]() -> Expected<std::unique_ptr<Plug>> {
      auto sender = DatagramSender::create(options.port.empty() ? landmarks_address : options.port);
      if (!sender) return tl::unexpected(sender.error());
      return std::make_unique<DatagramSender>(std::move(*sender));
    };
  } else {
    made.baud = options.baud;
    made.plug_in = [link]() -> Expected<std::unique_ptr<Plug>> {
      auto terminal = PseudoTerminal::open(link);
      if (!terminal) return tl::unexpected(terminal.error());
      return std::make_unique<PseudoTerminal>(std::move(*terminal));
    };
  }
  return made;
}

}  // namespace prehend::glove
