#pragma once

#include <chrono>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/time.hpp"

namespace prehend::ros {

/// Of several that lead at once one is followed: the first, until it has said nothing for half a
/// second. Who: of any type that can be compared. Pure.
template <class Who>
class OneSpeaker {
 public:
  /// May this one lead now? It does from then on.
  Expected<void> hear(const Who& who, Time now) {
    if (followed_ && followed_->who != who && now - followed_->heard < silence)
      return fail("comes from another node than the one that is followed", {},
                  "let one node lead: ros2 topic info --verbose names them");
    followed_ = {who, now};
    return {};
  }

 private:
  static constexpr Duration silence = std::chrono::milliseconds(500);
  struct Followed {
    Who who;
    Time heard;
  };
  std::optional<Followed> followed_;
};

}  // namespace prehend::ros
