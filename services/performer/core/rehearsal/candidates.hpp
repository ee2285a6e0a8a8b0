#pragma once

#include <vector>

#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"
#include "services/performer/core/reproduction/step_performer.hpp"

namespace prehend::performer {

/// How this hand may take an object that a person took at X_OG: that way with the open hand first,
/// then turned about the object's axis, then from above; what is low also a little lower; and each
/// with other preshapes. The likeliest come first. What its reach does not allow is left out; may
/// be empty.
std::vector<RobotGrasp> grasp_candidates(const model::HandModel& hand, const model::Shape& shape,
                                         const Pose& X_OG);

/// The same grasps as prehend-planner says them, of an object that a person took at X_OG: those
/// that come from nearest to there first, then the same from where the object looks the same.
std::vector<RobotGrasp> planned_grasps(const model::HandModel& hand, const model::Shape& shape,
                                       const Pose& X_OG,
                                       const std::vector<model::GraspCandidate>& planned);

}  // namespace prehend::performer
