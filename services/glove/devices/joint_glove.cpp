#include "services/glove/devices/joint_glove.hpp"

#include <fmt/format.h>

#include "common/base/clock.hpp"
#include "common/serial/serial_port.hpp"
#include "services/glove/devices/joint_emulator.hpp"
#include "services/glove/devices/joint_protocol.hpp"
#include "services/glove/devices/persistent.hpp"
#include "services/glove/devices/worn_joints.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr Duration answer_time = milliseconds(300);
constexpr Duration quiet = milliseconds(60);  // longer than the gap between two samples

class JointGlove final : public Device {
 public:
  JointGlove(const DeviceOptions& options, std::unique_ptr<WornJoints> worn)
      : path_(options.port), baud_(options.baud), rate_(options.rate), worn_(std::move(worn)) {}

  void start(DeviceSink sink) override {
    worn_->start(std::move(sink));
    thread_.start([this](const std::stop_token& stop) { return live(stop); },
                  worn_->sink().degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    const auto sensors = begin(*port);
    if (!sensors) return tl::unexpected(sensors.error());
    worn_->begin(*sensors);
    return listen(*port, *sensors, stop);
  }

  /// Ends a stream, asks for the number of sensors and starts streaming.
  Expected<std::size_t> begin(serial::SerialPort& port) {
    port.discard_input();
    if (auto sent = port.write("\x03"); !sent) return tl::unexpected(sent.error());
    if (auto drained = hear(port, quiet); !drained) return tl::unexpected(drained.error());
    if (auto sent = port.write("?S"); !sent) return tl::unexpected(sent.error());
    std::string heard;
    const auto until = Clock::now() + answer_time;
    while (!joint::answered('S', heard) && Clock::now() < until) {
      auto bytes = port.read(milliseconds(20));
      if (!bytes) return tl::unexpected(bytes.error());
      heard += *bytes;
    }
    const auto sensors = joint::answered('S', heard);
    if (!sensors)
      return tl::unexpected(port.overheard().unanswered(
          {"the glove does not answer", path_, "check that it is on, and its baud rate"}));
    if (*sensors != min_joint_sensors && *sensors != max_joint_sensors)
      return fail(fmt::format("the glove says that it has {} sensors", *sensors), path_,
                  "18 and 22 are known");
    const std::string setup = "u 0\r" + joint::period_command(rate_);
    if (auto sent = port.write(setup); !sent) return tl::unexpected(sent.error());
    if (auto drained = hear(port, quiet); !drained) return tl::unexpected(drained.error());
    if (auto sent = port.write("S"); !sent) return tl::unexpected(sent.error());
    return *sensors;
  }

  /// Reads, and forgets, until it is quiet for so long, but not for ever.
  Expected<void> hear(serial::SerialPort& port, Duration silence) {
    const auto until = Clock::now() + answer_time;
    while (Clock::now() < until) {
      auto bytes = port.read(silence);
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) break;
    }
    return {};
  }

  Expected<void> listen(serial::SerialPort& port, std::size_t sensors,
                        const std::stop_token& stop) {
    joint::RecordParser parser(sensors);
    std::uint64_t garbage = 0;
    auto last = Clock::now();
    const Duration max_silence = std::max<Duration>(milliseconds(500), seconds(3 / rate_));
    while (!stop.stop_requested()) {
      auto bytes = port.read(milliseconds(50));
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = process_now();
      for (const joint::Counts& counts : parser.feed(*bytes)) {
        last = Clock::now();
        thread_.well();
        worn_->deliver({counts.begin(), counts.end()}, std::nullopt, now);
      }
      if (parser.garbage() > garbage)
        worn_->sink().drop("garbage bytes", parser.garbage() - garbage);
      garbage = parser.garbage();
      if (Clock::now() - last > max_silence)
        return fail("the glove has fallen silent", path_, "starts it again by itself");
    }
    return {};
  }

  std::string path_;
  int baud_;
  double rate_;
  std::unique_ptr<WornJoints> worn_;
  Persistent thread_;  // last: joined before the rest goes
};

}  // namespace

Expected<std::unique_ptr<Device>> create_joint_glove(const DeviceOptions& options) {
  if (options.port.empty())
    return fail("no port is named", "glove.port", "name one such as /dev/ttyUSB0");
  if (options.baud < 2400 || options.baud > 115200)
    return fail("the glove knows 2400 to 115200 bits per second", "glove.baud");
  if (!(options.rate >= 1 && options.rate <= 200))
    return fail("the glove measures 1 to 200 times a second", "glove.rate");
  auto worn = WornJoints::create(options);
  if (!worn) return tl::unexpected(worn.error());
  return std::make_unique<JointGlove>(options, std::move(*worn));
}

std::unique_ptr<Emulator> emulate_joint_glove(const DeviceOptions& options) {
  const bool known =
      check(options.joint_gains) && options.joint_gains.gain.size() >= min_joint_sensors;
  const JointGains gains = known ? options.joint_gains : *typical_gains(max_joint_sensors);
  return std::make_unique<joint::Emulator>(
      joint::EmulatorOptions{.gains = gains, .hand_scale = options.hand_scale});
}

}  // namespace prehend::glove
