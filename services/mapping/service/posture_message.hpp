#pragma once

#include "common/dds/topics.hpp"
#include "services/mapping/core/mapping.hpp"

namespace prehend::mapping {

/// A hand/posture as the mapping takes it; fails on a pose that is none.
Expected<Posture> posture_from_message(const v1::HandPosture& message);

}  // namespace prehend::mapping
