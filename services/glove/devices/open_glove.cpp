#include "services/glove/devices/open_glove.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/clock.hpp"
#include "common/serial/serial_port.hpp"
#include "services/glove/devices/hand_in_frame.hpp"
#include "services/glove/devices/open_glove_line.hpp"
#include "services/glove/devices/persistent.hpp"
#include "services/glove/devices/worn_joints.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr Duration max_silence = milliseconds(500);
constexpr double counts_full = 255;  // as other gloves count

class OpenGlove final : public Device {
 public:
  OpenGlove(const DeviceOptions& options, std::unique_ptr<WornJoints> worn)
      : path_(options.port), baud_(options.baud), worn_(std::move(worn)) {}

  void start(DeviceSink sink) override {
    worn_->start(std::move(sink));
    thread_.start([this](const std::stop_token& stop) { return live(stop); },
                  worn_->sink().degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    port->discard_input();
    if (auto sent = port->write(open_glove::let_go); !sent) return tl::unexpected(sent.error());
    worn_->begin(finger_sensors);
    open_glove::LineParser parser;
    auto last = Clock::now();
    bool heard = false;
    while (!stop.stop_requested()) {
      const auto bytes = port->read(milliseconds(50));
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = process_now();
      for (const std::string& line : parser.feed(*bytes)) {
        // It waits for a line after each of its own, and keeps what it was told.
        if (auto sent = port->write(open_glove::let_go); !sent) return tl::unexpected(sent.error());
        if (!take(line, now)) continue;
        last = Clock::now();
        heard = true;
      }
      if (const auto lines = parser.take_overlong(); lines > 0)
        worn_->sink().drop("overlong line", lines);
      if (Clock::now() - last <= max_silence) continue;
      return tl::unexpected(
          heard ? Error{"the glove has fallen silent", path_, "starts it again by itself"}
                : port->overheard().unanswered(
                      {"the glove is silent", path_, "check that it is on, and its baud rate"}));
    }
    return {};
  }

  /// False: it was damaged, and counted.
  bool take(std::string_view line, Time now) {
    const auto sample = open_glove::parse(line);
    if (!sample) {
      worn_->sink().drop("damaged line", 1);
      return false;
    }
    std::vector<double> counts;
    for (const int finger : sample->fingers)
      counts.push_back(counts_full * finger / open_glove::full);
    thread_.well();
    worn_->deliver(std::move(counts), sample->held, now);
    return true;
  }

  std::string path_;
  int baud_;
  std::unique_ptr<WornJoints> worn_;
  Persistent thread_;  // last: joined before the rest goes
};

class OpenGloveEmulator final : public Emulator {
 public:
  explicit OpenGloveEmulator(const DeviceOptions& options)
      : gains_(options.joint_gains.gain.size() == finger_sensors && check(options.joint_gains)
                   ? options.joint_gains
                   : *typical_gains(finger_sensors)),
        hand_(options.hand_scale) {}

  std::string receive(std::string_view, Duration) override { return {}; }

  std::vector<std::string> measure(const Frame& frame, Duration) override {
    if (const auto seen = hand_in(frame, hand_, posture_)) posture_ = seen->posture;
    open_glove::Sample sample{.held = frame.held.value_or(std::vector<std::uint8_t>())};
    const auto counts = joint_counts(posture_, gains_);
    for (std::size_t f = 0; f < sample.fingers.size(); ++f)
      sample.fingers[f] = static_cast<int>(std::lround(counts[f] / counts_full * open_glove::full));
    return {open_glove::to_line(sample)};
  }

 private:
  JointGains gains_;
  model::HumanHand hand_;
  model::HumanPosture posture_ = model::HumanHand::open_posture();
};

}  // namespace

Expected<std::unique_ptr<Device>> create_open_glove(const DeviceOptions& options) {
  if (options.port.empty())
    return fail("no port is named", "glove.port", "name one such as /dev/ttyUSB0");
  auto worn = WornJoints::create(options);
  if (!worn) return tl::unexpected(worn.error());
  return std::make_unique<OpenGlove>(options, std::move(*worn));
}

std::unique_ptr<Emulator> emulate_open_glove(const DeviceOptions& options) {
  return std::make_unique<OpenGloveEmulator>(options);
}

}  // namespace prehend::glove
