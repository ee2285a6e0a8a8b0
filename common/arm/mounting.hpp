#pragma once

#include <vector>

#include "common/base/error.hpp"
#include "common/model/arm_model.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::arm {

/// X_FB of a hand on a flange, where nobody says otherwise: its grasp frame lies on the flange's
/// axis with the same axes, and what of its base reaches farthest back touches the flange. bend:
/// rad about the flange's y axis, by a bracket between the two. A bent hand grasps level things
/// close above a table and things below it without a wrist at its limits.
Pose mounted(const model::HandModel& hand, double bend = 0);

double weight_of(const model::HandModel& hand);  // kg

/// Fails when the arm cannot carry the hand.
Expected<void> check_fit(const model::ArmModel& arm, const model::HandModel& hand);

/// Capsules around the open hand, in the frame of the arm's last link, for Surroundings::carried.
std::vector<model::Capsule> carried(const model::ArmModel& arm, const model::HandModel& hand);

}  // namespace prehend::arm
