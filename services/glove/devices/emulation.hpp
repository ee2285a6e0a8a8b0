#pragma once

#include <functional>
#include <memory>

#include "common/serial/plug.hpp"
#include "services/glove/core/frame_source.hpp"
#include "services/glove/devices/emulator.hpp"
#include "services/glove/devices/faults.hpp"

namespace prehend::glove {

struct EmulationOptions {
  std::function<std::unique_ptr<Emulator>()> device;  // as it is when switched on
  std::function<Expected<std::unique_ptr<serial::Plug>>()>
      plug_in;          // asked again after an unplugging
  double rate = 30;     // Hz, measurements
  int baud = 0;         // 8N1; bytes take their time on the line. 0: they take none
  FaultOptions faults;  // that it makes
  /// Told where the host finds it, each time that it is plugged in.
  std::function<void(const std::string& where)> on_plugged = {};
};

/// Runs an emulated device that feels what the source says, in real time, until `stopped` says so.
/// On a line the source begins when the host first speaks, and rests at its beginning until then.
/// After its end the source stays as it was last. A device that is still sending its last records
/// when the next measurement is due leaves that out, as real ones do.
Expected<void> emulate(const EmulationOptions& options, const FrameSource& source,
                       const std::function<bool()>& stopped);

}  // namespace prehend::glove
