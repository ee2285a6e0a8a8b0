#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "common/serial/plug.hpp"

namespace prehend::serial {

/// Bytes on their way through a line of a certain speed, 8N1. Without one they take no time.
class Wire {
 public:
  explicit Wire(int baud) : byte_(baud > 0 ? seconds(10.0 / baud) : Duration::zero()) {}

  bool busy(Duration now) const { return free_ > now; }
  /// late: so much longer than the line takes, as where an adapter keeps it back; what comes after
  /// it does not overtake it.
  void send(std::string bytes, Duration now, Duration late = {}) {
    if (bytes.empty()) return;
    free_ = std::max(free_, now) + byte_ * static_cast<std::int64_t>(bytes.size());
    last_ = std::max(last_, free_ + late);
    on_it_.push_back({last_, std::move(bytes)});
  }
  /// When the next record will have arrived; none on its way: `otherwise`.
  Duration next(Duration otherwise) const {
    return on_it_.empty() ? otherwise : std::min(otherwise, on_it_.front().arrival);
  }
  /// The next record that has arrived; nothing: none has.
  std::optional<std::string> take(Duration now) {
    if (on_it_.empty() || on_it_.front().arrival > now) return std::nullopt;
    std::string bytes = std::move(on_it_.front().bytes);
    on_it_.pop_front();
    return bytes;
  }
  void deliver(Duration now, Plug& plug) {
    while (const auto bytes = take(now)) plug.write(*bytes);
  }

 private:
  struct Sent {
    Duration arrival;  // of the last byte
    std::string bytes;
  };
  Duration byte_, free_{}, last_{};  // last_: arrival of what was sent last
  std::deque<Sent> on_it_;
};

}  // namespace prehend::serial
