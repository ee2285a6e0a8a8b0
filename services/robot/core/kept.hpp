#pragma once

#include <algorithm>
#include <optional>

#include "common/base/time.hpp"

namespace prehend::robot {

/// For how long a joint has been kept from going where it shall go, by what was heard of it. When
/// nothing is heard for long, nobody knows how it was kept meanwhile: little of that time counts.
class Kept {
 public:
  /// free: it moves, is where it shall be, or is not pushed.
  void observe(bool free, Time now) {
    const Duration step = seen_ ? std::min<Duration>(now - *seen_, longest) : Duration{};
    time_ = free ? Duration{} : time_ + step;
    seen_ = now;
  }
  void forget() { *this = Kept(); }

  /// Something is in its way.
  bool stalled() const { return time_ > std::chrono::milliseconds(150); }
  /// It would have got past what yields.
  bool stuck() const { return time_ > std::chrono::milliseconds(1200); }

 private:
  static constexpr Duration longest = std::chrono::milliseconds(100);

  Duration time_{};
  std::optional<Time> seen_;
};

}  // namespace prehend::robot
