#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace prehend::service {

/// When a process joins anew after other keys were revoked: not all processes of a lab at once, and
/// not while it moves a hand, but for that it waits so long only. Pure.
class Rejoin {
 public:
  /// Processes differ in `delay`, up to max_delay.
  void ask(Time now, Duration delay) {
    if (!from_) from_ = now + delay;
  }
  bool is_due(Time now, bool busy) const {
    return from_ && now >= *from_ && (!busy || now >= *from_ + max_wait);
  }

  static constexpr Duration max_delay = std::chrono::seconds(3);
  static constexpr Duration max_wait = std::chrono::seconds(60);

 private:
  std::optional<Time> from_;
};

}  // namespace prehend::service
