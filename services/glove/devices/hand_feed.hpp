#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/devices/landmark_line.hpp"

namespace prehend::glove {

/// Where measurements of a bare hand come from, one after the other.
class HandFeed {
 public:
  virtual ~HandFeed() = default;
  struct Came {
    /// Of one picture: each hand, or why it cannot be used.
    std::vector<tl::expected<LandmarkLine, std::string_view>> hands = {};
    std::string_view refused = {};  // who sent it is not heard, for this reason
  };
  /// What has come, perhaps nothing; waits for it at most that long. Fails when it cannot be heard
  /// any more; it is then opened anew.
  virtual Expected<Came> read(Duration timeout) = 0;
};

struct HandFeedSource {
  std::function<Expected<std::unique_ptr<HandFeed>>()> open;
  std::string where;   // it is, for messages
  std::string advice;  // what to do when nothing comes
};

/// The device that uses such a feed. All five fingertips are used. The other hand, a second hand of
/// the same side, repeats, what is stale, from the future or out of order, and points that are no
/// hand, are refused and counted.
std::unique_ptr<Device> make_bare_hand(const DeviceOptions& options, HandFeedSource source);

/// The measurement as a feed's sender would tell it: without a stamp, in the room. Remembers what
/// it needs between measurements.
class HandTeller {
 public:
  explicit HandTeller(const DeviceOptions& options);
  /// Nothing: there is no hand.
  std::optional<LandmarkLine> tell(const Frame& frame);

 private:
  bool left_;
  Eigen::Vector3d left_to_right_T_;
  model::HumanHand hand_;
  model::HumanPosture posture_ = model::HumanHand::open_posture();
};

}  // namespace prehend::glove
