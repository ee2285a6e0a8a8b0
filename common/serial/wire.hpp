#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <utility>

#include "common/serial/plug.hpp"

namespace prehend::serial {

/// Bytes on their way through a line of a certain speed, 8N1. Without one they take no time.
class Wire {
 public:
  explicit Wire(int baud) : byte_(baud > 0 ? seconds(10.0 / baud) : Duration::zero()) {}

  bool busy(Duration now) const { return free_ > now; }
  /// late: so much longer than the line takes.
  void send(std::string bytes, Duration now, Duration late = {}) {
    if (bytes.empty()) return;
    free_ = std::max(free_, now) + byte_ * static_cast<std::int64_t>(bytes.size()) + late;
    on_it_.push_back({free_, std::move(bytes)});
  }
  /// When the next record will have arrived; none on its way: `otherwise`.
  Duration next(Duration otherwise) const {
    return on_it_.empty() ? otherwise : std::min(otherwise, on_it_.front().arrival);
  }
  void deliver(Duration now, Plug& plug) {
    for (; !on_it_.empty() && on_it_.front().arrival <= now; on_it_.pop_front())
      plug.write(on_it_.front().bytes);
  }

 private:
  struct Sent {
    Duration arrival;  // of the last byte
    std::string bytes;
  };
  Duration byte_, free_{};
  std::deque<Sent> on_it_;
};

}  // namespace prehend::serial
