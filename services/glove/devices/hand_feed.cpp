#include "services/glove/devices/hand_feed.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "common/base/clock.hpp"
#include "services/glove/core/plausible_hand.hpp"
#include "services/glove/devices/frame_clock.hpp"
#include "services/glove/devices/hand_in_frame.hpp"
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

class BareHandDevice final : public Device {
 public:
  BareHandDevice(const DeviceOptions& options, HandFeedSource source)
      : source_(std::move(source)),
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
    auto feed = source_.open();
    if (!feed) return tl::unexpected(feed.error());
    clock_.restart();
    auto last = Clock::now();
    while (!stop.stop_requested()) {
      const auto came = (*feed)->read(milliseconds(50));
      if (!came) return tl::unexpected(came.error());
      if (!came->refused.empty()) drop(came->refused);
      if (receive(*came, process_now())) last = Clock::now();
      if (Clock::now() - last <= max_silence) continue;
      // The feed stays open: who sends to a closed port is refused, and may give up.
      say(silence().message());
      refused_.clear();
      clock_.restart();
      last = Clock::now();
    }
    return {};
  }

  /// True if there was a hand in it.
  bool receive(const HandFeed::Came& came, Time now) {
    bool any = false;
    for (const auto& hand : came.hands) {
      const std::string_view reason = hand ? use(*hand, now, any) : hand.error();
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
    if (often == refused_.end()) return {"no landmarks come", source_.where, source_.advice};
    return {"landmarks come, but cannot be used: " + often->first, source_.where,
            std::string(advice_on(often->first))};
  }

  /// Why it cannot be used; empty if it was. `second`: the picture had a hand already.
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

  HandFeedSource source_;
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

}  // namespace

std::unique_ptr<Device> make_bare_hand(const DeviceOptions& options, HandFeedSource source) {
  return std::make_unique<BareHandDevice>(options, std::move(source));
}

HandTeller::HandTeller(const DeviceOptions& options)
    : left_(options.left),
      left_to_right_T_(left_to_right(options.X_WT)),
      hand_(options.hand_scale) {}

std::optional<LandmarkLine> HandTeller::tell(const Frame& frame) {
  const auto seen = hand_in(frame, hand_, posture_);
  if (!seen) return std::nullopt;
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
  return line;
}

}  // namespace prehend::glove
