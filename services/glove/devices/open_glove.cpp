#include "services/glove/devices/open_glove.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
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
      : path_(options.port),
        baud_(options.baud),
        full_force_(options.feedback_force),
        worn_(std::move(worn)) {}

  void start(DeviceSink sink) override {
    worn_->start(std::move(sink));
    thread_.start([this](const std::stop_token& stop) { return live(stop); },
                  worn_->sink().degraded);
  }

  void feel(const Feedback& feedback) override {
    const std::scoped_lock lock(mutex_);
    feedback_ = feedback;
    told_ = Clock::now();
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    port->discard_input();
    const std::string let_go = open_glove::to_line(open_glove::HeldBack{});
    if (auto sent = port->write(let_go); !sent) return tl::unexpected(sent.error());
    worn_->begin(finger_sensors);
    open_glove::LineParser parser;
    auto last = Clock::now();
    bool heard = false;
    while (!stop.stop_requested()) {
      const auto bytes = port->read(milliseconds(50));
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = process_now();
      for (const std::string& line : parser.feed(*bytes)) {
        const bool taken = take(line, now);
        // It waits for a line after each of its own, and keeps what it was told.
        if (auto sent = port->write(open_glove::to_line(held_back())); !sent)
          return tl::unexpected(sent.error());
        if (!taken) continue;
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
    return port->write(let_go);
  }

  /// A finger is kept from bending further than it does, the more the harder the robot's presses:
  /// it may always open.
  open_glove::HeldBack held_back() {
    open_glove::HeldBack shares{};
    const std::scoped_lock lock(mutex_);
    if (!feedback_ || full_force_ == 0 || Clock::now() - told_ > feedback_holds) return shares;
    for (std::size_t f = 0; f < shares.size(); ++f)
      shares[f] = std::min(1.0, feedback_->fingers[f].force / full_force_) *
                  (1 - std::clamp(closures_[f], 0.0, 1.0));
    if (felt_ != feedback_->stamp && worn_->sink().felt) worn_->sink().felt(feedback_->stamp);
    felt_ = feedback_->stamp;
    return shares;
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
    closures_ = finger_closures(counts, worn_->gains());
    worn_->deliver(std::move(counts), sample->held, now);
    return true;
  }

  std::string path_;
  int baud_;
  double full_force_;  // N
  std::unique_ptr<WornJoints> worn_;
  std::array<double, model::finger_count> closures_{};  // of the wearer's fingers
  Time felt_{};                                         // what was told last
  std::mutex mutex_;                                    // guards what comes from other threads
  std::optional<Feedback> feedback_;
  Clock::time_point told_{};
  Persistent thread_;  // last: joined before the rest goes
};

class OpenGloveEmulator final : public Emulator {
 public:
  explicit OpenGloveEmulator(const DeviceOptions& options)
      : gains_(options.joint_gains.gain.size() == finger_sensors && check(options.joint_gains)
                   ? options.joint_gains
                   : *typical_gains(finger_sensors)),
        hand_(options.hand_scale) {}

  std::string receive(std::string_view bytes, Duration) override {
    for (const std::string& line : heard_.feed(bytes))
      if (const auto held = open_glove::parse_held_back(line)) held_back_ = *held;
    return {};
  }

  std::vector<std::string> measure(const Frame& frame, Duration) override {
    if (const auto seen = hand_in(frame, hand_, posture_)) posture_ = seen->posture;
    open_glove::Sample sample{.held = frame.held.value_or(std::vector<std::uint8_t>())};
    const auto counts = joint_counts(posture_, gains_);
    const auto closures = finger_closures(counts, gains_);
    for (std::size_t f = 0; f < sample.fingers.size(); ++f) {
      // The wearer's finger stops where it is held.
      const double closed = std::min(closures[f], 1 - held_back_[f]);
      const double count = finger_count_at(closed, f, gains_) / counts_full;
      sample.fingers[f] = static_cast<int>(std::lround(count * open_glove::full));
    }
    return {open_glove::to_line(sample)};
  }

 private:
  JointGains gains_;
  model::HumanHand hand_;
  model::HumanPosture posture_ = model::HumanHand::open_posture();
  open_glove::LineParser heard_;
  open_glove::HeldBack held_back_{};
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
