#pragma once

#include "common/base/error.hpp"
#include "common/model/detection.hpp"
#include "idl/Perception.h"

namespace prehend::convert {

/// Refuses a pose that is none (convert.hpp); the rest is as it came.
Expected<model::Detection> from_message(const v1::ObjectDetection& message);

}  // namespace prehend::convert
