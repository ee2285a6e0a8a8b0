#pragma once

#include <string>

#include "common/gate/command_gate.hpp"
#include "tests/support/hands.hpp"

namespace prehend::gate {

inline const Time start = from_ns(1'700'000'000'000'000'000);
inline Time at(int ms) {
  return start + std::chrono::milliseconds(ms);
}

inline WriterId writer(std::uint8_t number) {
  WriterId id{};
  id[11] = number;
  return id;
}

inline Place open_at(const model::HandModel& hand, const Eigen::Vector3d& p) {
  return {hand.postures().at("open"), make_pose(p)};
}

/// A sound command, counted by its time.
inline Command command(const model::HandModel& hand, std::uint8_t from, int ms,
                       const Eigen::Vector3d& p = {0, 0, 0.5}) {
  return {writer(from),    static_cast<std::uint64_t>(ms), at(ms), "hand", hand.name(),
          open_at(hand, p)};
}

inline CommandGate made(const model::HandModel& hand, CommandGate::Where where = {}) {
  return CommandGate::create(hand, {.hand = "hand"}, limits_of(hand), std::move(where)).value();
}

}  // namespace prehend::gate
