#pragma once

#include <string>

#include "common/dds/topics.hpp"
#include "common/model/hand_model.hpp"
#include "services/planner/core/plan_book.hpp"

namespace prehend::planner {

/// A plan for this hand as grasp/candidates, without sequence number. hand_name: key of
/// robot/command.
v2::GraspCandidates to_message(const TrackPlan& planned, const std::string& hand_name,
                               const model::HandModel& hand);

}  // namespace prehend::planner
