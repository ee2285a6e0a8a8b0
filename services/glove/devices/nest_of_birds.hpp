#pragma once

#include "device.hpp"

namespace prehend::glove {

/// Driver of Ascension's Nest of Birds, or of a Flock of Birds, on a serial port; see
/// bird_protocol.hpp for how surely its command set is known. Sensors are on the back of the hand,
/// thumb, index and little finger, in the order of their addresses.
///
/// It stops a stream that still runs, resets and auto-configures the units unless they run already,
/// sets the 72 inch range, group mode and the format, and streams. A port that is not there, or
/// goes away, or falls silent, is tried again for ever.
Expected<std::unique_ptr<Device>> create_nest_of_birds(const DeviceOptions& options);

}  // namespace prehend::glove
