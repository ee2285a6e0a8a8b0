#include "services/robot/core/silence.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace prehend::robot {

void Silence::end(Time now) {
  began_ = looked_ = now;
  listened_ = {};
}

void Silence::listen(Time now) {
  constexpr Duration longest = std::chrono::milliseconds(50);
  listened_ += std::min<Duration>(now - looked_, longest);
  looked_ = now;
}

std::string Silence::words(Time now) const {
  const Duration all = now - began_;
  if (2 * listened_ > all) return "the wire is lost";
  return fmt::format("was left alone for {:.2f} s, as this machine was too busy", to_seconds(all));
}

}  // namespace prehend::robot
