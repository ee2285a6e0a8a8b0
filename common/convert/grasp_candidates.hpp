#pragma once

#include "common/base/error.hpp"
#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "idl/Planning.h"

namespace prehend::convert {

/// A message of grasp/candidates as a book of them takes it. Refuses what was planned for another
/// kind of hand, and poses that are none.
Expected<model::GraspCandidates> from_message(const v2::GraspCandidates& message,
                                              const model::HandModel& hand);

}  // namespace prehend::convert
