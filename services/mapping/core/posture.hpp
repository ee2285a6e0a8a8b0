#pragma once

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "services/mapping/core/features.hpp"

namespace prehend::mapping {

/// A hand as hand/posture says it.
struct Posture {
  Time stamp, origin;  // acquisition, and head of the chain
  Pose X_WH = Pose::Identity();
  double hand_scale = 1;
  Fingertips fingertips;
};

}  // namespace prehend::mapping
