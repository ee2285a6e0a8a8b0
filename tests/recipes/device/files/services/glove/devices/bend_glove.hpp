#pragma once

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// Driver of a glove with five bend sensors on a microcontroller with a serial port. After "go\n"
/// it sends a line for each measurement, thumb first, 0 open to 999 closed, and the exclusive or of
/// the characters before the star in hexadecimal: "B 012 345 678 901 234*5A\n".
///
/// It does not measure where the hand is: the hand stays at the scene's X_WH.
Expected<std::unique_ptr<Device>> create_bend_glove(const DeviceOptions& options);

/// The glove itself.
std::unique_ptr<Emulator> emulate_bend_glove(const DeviceOptions& options);

}  // namespace prehend::glove
