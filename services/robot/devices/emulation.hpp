#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "common/serial/line_faults.hpp"
#include "common/serial/plug.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot {

/// What goes wrong with robots and their lines. Times are s after the start; negative: never.
struct FaultOptions {
  serial::LineFaults line;  // of the bytes on the wire
  double late = 0;          // share of answers that come late_by after their time
  double late_by = 0.15;    // s, that these are late
  double silent_at = -1;    // from when on it says and hears nothing
  double silent_for = 1;    // s, that this lasts
  double cut_at = -1;       // when the cable is pulled out; the robot keeps its power
  double cut_for = 2;       // s, until it is plugged in again
  double hot_at = -1;       // when its motors are hot
  double hot_for = 2;       // s, until they have cooled down
  double hot = 80;          // °C, that they then have
  double stuck_at = -1;     // when a joint does not move any more
  double stuck_for = 3;     // s, until it does
  std::size_t stuck = 0;    // DoF of that joint
  double restart_at = -1;   // when it is switched off and on, and forgets
  std::uint64_t seed = 1;   // the same makes the same faults
};

struct EmulationOptions {
  std::function<Expected<std::unique_ptr<serial::Plug>>()> plug_in;  // asked again after a cut
  int baud = 0;         // bytes take their time on the line; 0: they take none
  FaultOptions faults;  // that it makes
  /// Told where the host finds it, each time that it is plugged in.
  std::function<void(const std::string& where)> on_plugged = {};
  /// Called after each step, for a twin.
  std::function<void(Emulator& robot)> on_step = {};
};

/// Runs an emulated robot in real time, until `stopped` says so.
Expected<void> emulate(const EmulationOptions& options, Emulator& robot,
                       const std::function<bool()>& stopped);

}  // namespace prehend::robot
