#include "services/glove/devices/bend_glove.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/clock.hpp"
#include "common/serial/serial_port.hpp"
#include "services/glove/devices/frame_clock.hpp"
#include "services/glove/devices/hand_in_frame.hpp"
#include "services/glove/devices/persistent.hpp"

namespace prehend::glove {
namespace bend {

using Closures = std::array<double, model::finger_count>;  // 0 open to 1 closed

constexpr double full = 999;        // counts
constexpr std::size_t length = 24;  // of a line without its end
constexpr std::string_view start = "go\n";
constexpr Duration max_silence = std::chrono::milliseconds(500);

unsigned checksum(std::string_view text) {
  return std::accumulate(text.begin(), text.end(), 0U,
                         [](unsigned sum, char c) { return sum ^ static_cast<unsigned char>(c); });
}

std::string line_of(const Closures& closures) {
  std::string text = "B";
  for (const double closure : closures)
    text += fmt::format(" {:03}", std::lround(full * std::clamp(closure, 0.0, 1.0)));
  return fmt::format("{}*{:02X}\n", text, checksum(text));
}

/// Nothing if it is not a whole line.
std::optional<Closures> read_line(std::string_view line) {
  if (line.size() != length || line[0] != 'B' || line[length - 3] != '*') return std::nullopt;
  if (fmt::format("{:02X}", checksum(line.substr(0, length - 3))) != line.substr(length - 2))
    return std::nullopt;
  Closures closures{};
  for (std::size_t f = 0; f < closures.size(); ++f) {
    int count = 0;
    const std::string_view digits = line.substr(2 + 4 * f, 3);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + 3, count);
    if (error != std::errc() || end != digits.data() + 3 || count < 0) return std::nullopt;
    closures[f] = count / full;
  }
  return closures;
}

class Glove final : public Device {
 public:
  explicit Glove(const DeviceOptions& options)
      : path_(options.port), baud_(options.baud), left_(options.left) {
    const Pose X_TH = options.X_WT.inverse() * options.scene.X_WH;
    resting_.p_TS = X_TH.translation();
    resting_.q_TS = Eigen::Quaterniond(X_TH.linear());
  }

  void start(DeviceSink sink) override {
    sink_ = std::move(sink);
    thread_.start([this](const std::stop_token& stop) { return live(stop); }, sink_.degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto port = serial::SerialPort::open(path_, baud_);
    if (!port) return tl::unexpected(port.error());
    port->discard_input();
    if (auto sent = port->write(bend::start); !sent) return sent;
    clock_.restart();
    std::string pending;
    auto last = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
      const auto bytes = port->read(std::chrono::milliseconds(50));
      if (!bytes) return tl::unexpected(bytes.error());
      const Time now = process_now();
      pending += *bytes;
      for (std::size_t end = pending.find('\n'); end != std::string::npos;
           end = pending.find('\n')) {
        if (deliver(std::string_view(pending).substr(0, end), now))
          last = std::chrono::steady_clock::now();
        pending.erase(0, end + 1);
      }
      if (pending.size() > 4 * length) pending.clear();  // noise without an end
      if (std::chrono::steady_clock::now() - last > max_silence)
        return fail("the glove has fallen silent", path_, "starts it again by itself");
    }
    return {};
  }

  bool deliver(std::string_view line, Time now) {
    const auto closures = read_line(line);
    if (!closures) {
      sink_.drop("garbage bytes", line.size() + 1);
      return false;
    }
    const model::HumanPosture posture =
        model::HumanHand(1).clamp(model::HumanHand::posture(*closures));
    Frame frame;
    frame.sequence = sequence_++;
    frame.stamp = clock_.stamp(now);
    frame.readings.push_back(resting_);
    frame.joint_angles.assign(posture.begin(), posture.end());
    frame.left = left_;
    thread_.well();
    sink_.frame(std::move(frame));
    return true;
  }

  std::string path_;
  int baud_;
  bool left_;
  Reading resting_{};
  DeviceSink sink_;
  std::uint64_t sequence_ = 0;
  FrameClock clock_;
  Persistent thread_;  // last: joined before the rest goes
};

/// How far each finger is from open to closed, by its bending alone.
Closures closures_of(const model::HumanPosture& posture) {
  const model::HumanPosture open = model::HumanHand::open_posture(),
                            span = model::HumanHand::fist_posture() - open;
  Closures closures{};
  for (std::size_t f = 0; f < closures.size(); ++f) {
    const auto bend = static_cast<Eigen::Index>(f == 0 ? 18 : 4 * f - 2);  // thumb MCP, else PIP
    closures[f] = (posture[bend] - open[bend]) / span[bend];
  }
  return closures;
}

class GloveEmulator final : public Emulator {
 public:
  explicit GloveEmulator(double scale) : hand_(scale), posture_(model::HumanHand::open_posture()) {}

  std::string receive(std::string_view bytes, Duration) override {
    on_ = on_ || bytes.find("go") != std::string_view::npos;
    return {};
  }
  std::vector<std::string> measure(const Frame& frame, Duration) override {
    if (const auto seen = hand_in(frame, hand_, posture_)) posture_ = seen->posture;
    if (!on_) return {};
    return {line_of(closures_of(posture_))};
  }

 private:
  model::HumanHand hand_;
  model::HumanPosture posture_;
  bool on_ = false;
};

}  // namespace bend

Expected<std::unique_ptr<Device>> create_bend_glove(const DeviceOptions& options) {
  if (options.port.empty())
    return fail("no port is named", "glove.port", "name one such as /dev/ttyUSB0");
  return std::make_unique<bend::Glove>(options);
}

std::unique_ptr<Emulator> emulate_bend_glove(const DeviceOptions& options) {
  return std::make_unique<bend::GloveEmulator>(options.hand_scale);
}

}  // namespace prehend::glove
