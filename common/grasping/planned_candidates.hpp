#pragma once

#include <vector>

#include "common/grasping/world.hpp"
#include "common/model/grasp_candidates.hpp"

namespace prehend::grasping {

/// The shape for which grasps are planned: things that are seen a little differently share a plan.
model::Shape shape_to_plan(const model::Shape& seen);

/// What prehend-planner finds for this object, of a shape_to_plan(), once it has searched all; the
/// one with the most room first. Empty where there is none, or for what cannot be an object.
std::vector<model::GraspCandidate> planned_candidates(const model::HandModel& hand,
                                                      const Body& object);

}  // namespace prehend::grasping
