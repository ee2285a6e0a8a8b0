#pragma once

#include <cstdint>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/field_path.hpp"

namespace prehend::recorder::dataset {

/// A picture of a message, as the file that a picture decoder reads. The field has its bytes.
/// Where `step` stands beside them, as in sensor_msgs/Image, they are raw, and made a png. Refused:
/// what `ros2::pixels_of` refuses.
Expected<std::vector<std::uint8_t>> picture_file(const recording::types::Value& message,
                                                 const FieldPath& field);

}  // namespace prehend::recorder::dataset
