#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace prehend::tool {

/// Whether a key is held, on a terminal that only says when it is pressed, and again and again
/// while it stays down. The first repeat comes late, after up to 0.7 s: only with the repeats is it
/// held, so that letting go is seen soon.
class HeldKey {
 public:
  void press(Time now) {
    repeats_ = last_ && now - *last_ <= max_gap;
    last_ = now;
  }
  bool held(Time now) const { return repeats_ && now - *last_ <= max_gap; }

 private:
  /// Repeats come every 30 to 50 ms.
  static constexpr Duration max_gap = std::chrono::milliseconds(120);
  std::optional<Time> last_;
  bool repeats_ = false;
};

}  // namespace prehend::tool
