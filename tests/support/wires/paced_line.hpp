#pragma once

#include <string>

#include "tests/support/wires/wired_hands.hpp"

namespace prehend::test {

/// How fast a driver and its hand take turns over a line.
struct Cycle {
  double rounds = 0;         // a second: each a reading of all joints, beside what is told
  double bytes = 0;          // of a round, both ways
  std::string trouble = {};  // it does not become ready, or does not stay so: why
};

/// Measured for so many seconds through a pseudo-terminal that both ways are paced at that baud:
/// the driver with the line that prehend-robot has, in its tick of 2 ms, and the emulated hand in a
/// thread of its own. The hand is led, each time elsewhere. rate: Hz, that the driver is to keep,
/// as far as the line has room.
Cycle measure_cycle(const WiredHand& wired, int baud, double rate, double seconds);

}  // namespace prehend::test
