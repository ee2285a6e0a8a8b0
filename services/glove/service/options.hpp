#pragma once

#include "common/base/error.hpp"
#include "common/service/config.hpp"
#include "services/glove/devices/device.hpp"

namespace prehend::glove {

/// What a device needs, from lab.toml and the files that it names. Without a scene the hand moves
/// over the table's origin.
Expected<DeviceOptions> device_options(const service::Config& config);

}  // namespace prehend::glove
