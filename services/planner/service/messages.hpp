#pragma once

#include <string>

#include "common/dds/topics.hpp"
#include "services/planner/core/plan_book.hpp"

namespace prehend::planner {

/// An object/detection as the planner takes it; fails on a pose that is none.
Expected<SeenObject> seen_from_message(const v1::ObjectDetection& message);

/// A plan as grasp/candidates, without sequence number. hand: key of robot/command; model: kind of
/// robot hand.
v1::GraspCandidates to_message(const TrackPlan& planned, const std::string& hand,
                               const std::string& model);

}  // namespace prehend::planner
