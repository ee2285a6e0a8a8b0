#pragma once

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// Driver of a CyberGlove-class glove, 18 or 22 sensors, on a serial port; see joint_protocol.hpp
/// for how surely its protocol is known. Its frames have joint angles, by options.joint_gains or,
/// where these are empty or of another number of sensors, typical gains, which it says.
///
/// It does not measure where the hand is. With options.wrist_port a bird tracker with one sensor on
/// the back of the hand does; while that is silent, the back of the hand is not valid. Without one
/// the hand stays at the scene's X_WH.
Expected<std::unique_ptr<Device>> create_joint_glove(const DeviceOptions& options);

/// The glove itself, worn by somebody with options.joint_gains; without these it has 22 sensors.
std::unique_ptr<Emulator> emulate_joint_glove(const DeviceOptions& options);

}  // namespace prehend::glove
