#include "services/glove/devices/joint_glove.hpp"

#include <fmt/format.h>

#include <mutex>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/serial/serial_port.hpp"
#include "services/glove/devices/frame_clock.hpp"
#include "services/glove/devices/joint_emulator.hpp"
#include "services/glove/devices/joint_protocol.hpp"
#include "services/glove/devices/nest_of_birds.hpp"
#include "services/glove/devices/persistent.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr Duration answer_time = milliseconds(300);
constexpr Duration quiet = milliseconds(60);          // longer than the gap between two samples
constexpr Duration wrist_memory = milliseconds(150);  // for which its last pose holds

/// The back of the hand as a tracker on another port sees it.
class Wrist {
 public:
  explicit Wrist(std::unique_ptr<Device> tracker) : tracker_(std::move(tracker)) {}

  void start(const DeviceSink& sink) {
    tracker_->start({.frame =
                         [this](const Frame& frame) {
                           const std::lock_guard lock(mutex_);
                           reading_ = frame.readings.at(0);
                           seen_ = Clock::now();
                         },
                     .degraded = sink.degraded,
                     .drop = sink.drop});
  }
  Reading now() {
    const std::lock_guard lock(mutex_);
    Reading reading = reading_;
    reading.valid = reading.valid && Clock::now() - seen_ <= wrist_memory;
    return reading;
  }

 private:
  std::mutex mutex_;
  Reading reading_{.valid = false};
  Clock::time_point seen_{};
  std::unique_ptr<Device> tracker_;  // last: its thread ends before the rest goes
};

class JointGlove final : public Device {
 public:
  JointGlove(const DeviceOptions& options, std::unique_ptr<Device> tracker)
      : path_(options.port),
        baud_(options.baud),
        rate_(options.rate),
        left_(options.left),
        left_to_right_T_(left_to_right(options.X_WT)),
        gains_(options.joint_gains),
        wrist_(tracker ? std::make_unique<Wrist>(std::move(tracker)) : nullptr) {
    const Pose X_TH = options.X_WT.inverse() * options.scene.X_WH;
    resting_.p_TS = X_TH.translation();
    resting_.q_TS = Eigen::Quaterniond(X_TH.linear());
  }

  void start(DeviceSink sink) override {
    sink_ = std::move(sink);
    if (wrist_) wrist_->start(sink_);
    thread_.start([this](const std::stop_token& stop) { return live(stop); }, sink_.degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    const auto sensors = begin(*port);
    if (!sensors) return tl::unexpected(sensors.error());
    if (gains_.gain.size() != *sensors) {
      if (!gains_.gain.empty())
        log::warning("{}: the calibration is for {} sensors, the glove has {}", path_,
                     gains_.gain.size(), *sensors);
      log::warning("{}: typical gains are used; calibrate for right joint angles", path_);
      gains_ = *typical_gains(*sensors);
    }
    clock_.restart();
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
    if (joint_sensors_of(*sensors).empty())
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
        deliver(counts, now);
      }
      if (parser.garbage() > garbage) sink_.drop("garbage bytes", parser.garbage() - garbage);
      garbage = parser.garbage();
      if (Clock::now() - last > max_silence)
        return fail("the glove has fallen silent", path_, "starts it again by itself");
    }
    return {};
  }

  void deliver(const joint::Counts& counts, Time now) {
    Frame frame;
    frame.sequence = sequence_++;
    frame.stamp = clock_.stamp(now);
    frame.readings.push_back(wrist_ ? wrist_->now() : resting_);
    frame.joint_counts.assign(counts.begin(), counts.end());
    const model::HumanPosture posture = joint_angles(frame.joint_counts, gains_);
    frame.joint_angles.assign(posture.begin(), posture.end());
    // Joint angles are those of either hand; a tracker's pose is mirrored, the scene's is not.
    if (left_ && wrist_) frame = mirrored(std::move(frame), left_to_right_T_);
    frame.left = left_;
    thread_.well();
    sink_.frame(std::move(frame));
  }

  std::string path_;
  int baud_;
  double rate_;
  bool left_;
  Eigen::Vector3d left_to_right_T_;
  JointGains gains_;
  Reading resting_{};
  DeviceSink sink_;
  std::uint64_t sequence_ = 0;
  FrameClock clock_;
  std::unique_ptr<Wrist> wrist_;
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
  if (!options.joint_gains.gain.empty())
    if (const auto good = check(options.joint_gains); !good) return tl::unexpected(good.error());
  std::unique_ptr<Device> tracker;
  if (!options.wrist_port.empty()) {
    DeviceOptions wrist = options;
    wrist.port = options.wrist_port;
    wrist.sites = {Site::back_of_hand};
    auto made = create_nest_of_birds(wrist);
    if (!made) return made;
    tracker = std::move(*made);
  }
  return std::make_unique<JointGlove>(options, std::move(tracker));
}

std::unique_ptr<Emulator> emulate_joint_glove(const DeviceOptions& options) {
  const JointGains gains =
      check(options.joint_gains) ? options.joint_gains : *typical_gains(max_joint_sensors);
  return std::make_unique<joint::Emulator>(
      joint::EmulatorOptions{.gains = gains, .hand_scale = options.hand_scale});
}

}  // namespace prehend::glove
