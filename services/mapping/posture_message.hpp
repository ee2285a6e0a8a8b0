#pragma once

#include <prehend/dds/topics.hpp>

#include "mapping.hpp"

namespace prehend::mapping {

/// A hand/posture as the mapping takes it; fails on a pose that is none.
Expected<Posture> posture_from_message(const v1::HandPosture& message);

}  // namespace prehend::mapping
