#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/serial/plug.hpp"
#include "services/robot/devices/faulty_robot.hpp"

namespace prehend::robot {

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
