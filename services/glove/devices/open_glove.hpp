#pragma once

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// Driver of an open glove (LucidGloves) on a serial port; see open_glove_line.hpp for how surely
/// its protocol is known. A sensor bends with each finger; gains and the back of the hand are as of
/// joint_glove.hpp. Which end of a sensor is open differs by how the glove was built, so it is to
/// be calibrated. Splay, stick and gestures of the glove are not used.
Expected<std::unique_ptr<Device>> create_open_glove(const DeviceOptions& options);

/// The glove itself, worn by somebody with options.joint_gains.
std::unique_ptr<Emulator> emulate_open_glove(const DeviceOptions& options);

}  // namespace prehend::glove
