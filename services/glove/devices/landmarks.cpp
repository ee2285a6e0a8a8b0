#include "services/glove/devices/landmarks.hpp"

#include <algorithm>
#include <map>

#include "common/base/clock.hpp"
#include "services/glove/core/plausible_hand.hpp"
#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/frame_clock.hpp"
#include "services/glove/devices/hand_in_frame.hpp"
#include "services/glove/devices/landmark_line.hpp"
#include "services/glove/devices/persistent.hpp"

namespace prehend::glove {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr double stale = 0.3;  // s, as the processor has it
constexpr Duration max_silence = milliseconds(500);

/// How far any point moves at least between two measurements of a living hand, m. Trackers have
/// more noise, also where they round.
constexpr double frozen = 1e-6;

bool is_still(const Landmarks& a, const Landmarks& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if ((a[i] - b[i]).cwiseAbs().maxCoeff() > frozen) return false;
  return true;
}

class LandmarksDevice final : public Device {
 public:
  LandmarksDevice(const DeviceOptions& options, ReceiverOptions receiver)
      : receiver_(std::move(receiver)),
        left_(options.left),
        hand_scale_(options.hand_scale),
        X_TH_(options.X_WT.inverse() * options.scene.X_WH),
        left_to_right_T_(left_to_right(options.X_WT)) {
    last_points_.fill(Eigen::Vector3d::Zero());
  }

  void start(DeviceSink sink) override {
    sink_ = std::move(sink);
    thread_.start([this](const std::stop_token& stop) { return live(stop); }, sink_.degraded);
  }

 private:
  Expected<void> live(const std::stop_token& stop) {
    auto socket = DatagramReceiver::bind(receiver_);
    if (!socket) return tl::unexpected(socket.error());
    clock_.restart();
    auto last = Clock::now();
    while (!stop.stop_requested()) {
      const auto datagram = socket->read(milliseconds(50));
      if (!datagram) return tl::unexpected(datagram.error());
      if (!datagram->refused.empty()) drop(datagram->refused);
      if (receive(datagram->bytes, process_now())) last = Clock::now();
      if (Clock::now() - last <= max_silence) continue;
      // The port stays open: who sends to a closed one is refused, and may give up.
      say(silence().message());
      refused_.clear();
      clock_.restart();
      last = Clock::now();
    }
    return {};
  }

  /// True if there was a hand in it.
  bool receive(std::string_view datagram, Time now) {
    bool any = false;
    for (const std::string_view text : documents_in(datagram)) {
      const auto line = parse_landmarks(text);
      const std::string_view reason = line ? use(*line, now, any) : line.error();
      if (!reason.empty()) drop(reason);
      any = any || reason.empty();
    }
    if (any) refused_.clear();
    return any;
  }

  /// Once, until it is another complaint or a hand has come.
  void say(std::string complaint) {
    if (complaint != said_) sink_.degraded(complaint);
    said_ = std::move(complaint);
  }

  void drop(std::string_view reason) {
    ++refused_[std::string(reason)];
    sink_.drop(reason, 1);
  }

  /// What is wrong when no hand comes: nothing does, or none of it can be used.
  Error silence() const {
    const auto often =
        std::ranges::max_element(refused_, {}, [](const auto& entry) { return entry.second; });
    if (often == refused_.end())
      return {"no landmarks come", receiver_.address, "start the hand tracking program"};
    return {"landmarks come, but cannot be used: " + often->first, receiver_.address,
            std::string(advice_on(often->first))};
  }

  /// Why it cannot be used; empty if it was. `second`: the datagram had a hand already.
  std::string_view use(const LandmarkLine& line, Time now, bool second) {
    if (line.left != left_) return "other hand";
    if (const std::string_view why = why_no_hand(line.points, line.left); !why.empty()) return why;
    if (line.stamp) {
      const Time stamp(seconds(*line.stamp));
      const double age = to_seconds(now - stamp);
      if (age > stale) return "stale";
      if (age < -stale) return "from the future";
      if (stamp == last_stamp_) return line.points == last_points_ ? "repeated" : "second hand";
      if (stamp < last_stamp_) return "out of order";
      last_stamp_ = stamp;
      if (is_still(line.points, last_points_)) return "frozen";
    } else {
      if (second) return "second hand";
      if (line.points == last_points_) return "repeated";
      last_stamp_ = clock_.stamp(std::max(now, last_stamp_));
    }
    last_points_ = line.points;

    BareHand hand = bare_hand(line.points, line.left);
    if (line.left) mirror(hand, left_to_right_T_);
    auto frame = sensors_on(hand, hand_scale_, line.in_room ? std::nullopt : std::optional(X_TH_));
    if (!frame) return "not a hand";
    frame->sequence = sequence_++;
    frame->stamp = last_stamp_;
    frame->held = line.held;
    thread_.well();
    said_.clear();
    sink_.frame(std::move(*frame));
    return {};
  }

  ReceiverOptions receiver_;
  bool left_;
  double hand_scale_;
  Pose X_TH_;  // where a hand is held of which that is not known
  Eigen::Vector3d left_to_right_T_;
  DeviceSink sink_;
  std::uint64_t sequence_ = 0;
  Time last_stamp_{};
  Landmarks last_points_;
  std::map<std::string, std::uint64_t> refused_;  // since the last usable hand, by reason
  FrameClock clock_;
  std::string said_;   // what was complained of
  Persistent thread_;  // last: joined before the rest goes
};

/// Sends a line for every measurement, without a stamp: it has no clock.
class LandmarksEmulator final : public Emulator {
 public:
  explicit LandmarksEmulator(const DeviceOptions& options)
      : left_(options.left),
        left_to_right_T_(left_to_right(options.X_WT)),
        hand_(options.hand_scale) {}

  std::string receive(std::string_view, Duration) override { return {}; }

  std::vector<std::string> measure(const Frame& frame, Duration) override {
    const auto seen = hand_in(frame, hand_, posture_);
    if (!seen) return {};
    posture_ = seen->posture;
    LandmarkLine line{.left = left_, .in_room = true, .points = landmarks_of(hand_, posture_)};
    for (auto& point : line.points) point = seen->X_TH * point;
    // Tips are where the source has them, reachable or not.
    for (const Reading& reading : frame.readings)
      if (const auto finger = finger_of(reading.site))
        line.points[4 * static_cast<std::size_t>(*finger) + 4] = reading.p_TS;
    line.held = frame.held;
    // The source has right hands; a left one is their image.
    if (left_)
      for (auto& point : line.points) point -= 2 * left_to_right_T_.dot(point) * left_to_right_T_;
    return {to_line(line) + "\n"};
  }

 private:
  bool left_;
  Eigen::Vector3d left_to_right_T_;
  model::HumanHand hand_;
  model::HumanPosture posture_ = model::HumanHand::open_posture();
};

}  // namespace

Expected<std::unique_ptr<Device>> create_landmarks(const DeviceOptions& options) {
  ReceiverOptions receiver{.address = options.port.empty() ? landmarks_address : options.port,
                           .senders = options.senders,
                           .token = options.token,
                           .secured = options.secured};
  if (const auto good = DatagramReceiver::check(receiver); !good)
    return tl::unexpected(good.error());
  return std::make_unique<LandmarksDevice>(options, std::move(receiver));
}

std::unique_ptr<Emulator> emulate_landmarks(const DeviceOptions& options) {
  return std::make_unique<LandmarksEmulator>(options);
}

}  // namespace prehend::glove
