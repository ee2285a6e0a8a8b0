#pragma once

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// Driver of Ascension's Nest of Birds, or of a Flock of Birds, on a serial port; see
/// bird_protocol.hpp for how surely its command set is known. options.sites says where its sensors
/// sit.
///
/// It ends a stream that still runs, resets and auto-configures the units unless they run already,
/// sets range, hemisphere and format of each, and streams, or asks for each frame. Stamps are those
/// of the tracker's own rate (frame_clock.hpp). A port that is not there, or goes away, or falls
/// silent, is tried again for ever.
Expected<std::unique_ptr<Device>> create_nest_of_birds(const DeviceOptions& options);

/// The tracker itself, without the magnets.
std::unique_ptr<Emulator> emulate_nest_of_birds(const DeviceOptions& options);

}  // namespace prehend::glove
