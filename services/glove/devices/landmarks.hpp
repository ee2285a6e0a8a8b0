#pragma once

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// Landmarks of a bare hand from a hand tracking program, as datagrams to options.port, host and
/// port; empty: 127.0.0.1:9870. The lines are described in landmark_line.hpp. All five fingertips
/// are used. Others than options.senders, datagrams without options.token, the other hand, a second
/// hand of the same side, repeats, what is stale, from the future or out of order, and points that
/// are no hand, are refused and counted.
Expected<std::unique_ptr<Device>> create_landmarks(const DeviceOptions& options);

/// A hand tracking program without its camera.
std::unique_ptr<Emulator> emulate_landmarks(const DeviceOptions& options);

/// Where datagrams go unless something else is said: nobody outside of this machine gets there.
inline constexpr const char* landmarks_address = "127.0.0.1:9870";

}  // namespace prehend::glove
