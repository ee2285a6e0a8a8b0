#pragma once

#include "common/dds/topics.hpp"
#include "services/mapping/core/finger_feedback.hpp"
#include "services/mapping/core/mapping.hpp"

namespace prehend::mapping {

/// A hand/posture as the mapping takes it; fails on a pose that is none.
Expected<Posture> posture_from_message(const v1::HandPosture& message);
/// The same of robot/state.
Expected<RobotState> state_from_message(const v1::HandState& message);
/// The same of robot/touch: what each link feels.
std::vector<LinkTouch> touch_from_message(const v1::HandTouch& message);

v1::GloveFeedback to_message(const model::HandFeedback& feedback);

}  // namespace prehend::mapping
