#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/wires/wired_hands.hpp"

namespace prehend::test {

/// A fault as `prehend robot emulate` makes it, without the dashes; with «10 %» and without: of a
/// tenth of the answers, and of all. Those of ros2_control alone: «other joints», «out of range»;
/// of both ends together, as a busy machine does it, for half a second: «held-up».
struct PlayedFault {
  std::string_view name;
  bool (*befalls)(const WiredHand& wired);
};
const std::vector<PlayedFault>& played_faults();

/// What came of it. Seconds are computed ones, to 2 ms.
struct FaultPlay {
  std::optional<double> named;  // s, from its begin until the hand is not ready any more
  std::string words;            // that the driver then says
  std::optional<double> held;   // s, from its begin until each joint is where it stays
  std::optional<double> ready;  // s, from its end until the hand is ready and stays so; 0: before
  bool homed = false;           // and had to be homed for that
  bool follows = false;         // in the end it goes again where it is led
  double astray = 0;            // rad or m: how far a fresh reading was off where a joint was
  std::size_t rejects = 0;      // answers that were left out while the fault lasted,
  std::string reject;           // and as what the first of them was counted
};

inline constexpr double fault_lasts = 2;  // s

/// Plays a driver and its emulated hand over a line that is as fast as the emulator's, in computed
/// time and ticks of 2 ms, as prehend-robot calls them: it is led, the fault comes, and lasts for
/// fault_lasts; when the driver ends the hand's readiness, nothing is led until it is ready again.
FaultPlay play(const WiredHand& wired, const PlayedFault& fault, std::uint64_t seed);

}  // namespace prehend::test
