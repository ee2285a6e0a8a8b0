#pragma once

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "idl/Robot.h"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// What a robot measured, as the simulation says it. Joints that no encoder sees are where their
/// drive is; what a drive presses with is said of the joint that leads it.
v1::HandState to_message(const Reading& reading, const model::HandModel& hand, const Pose& X_WB);

/// What its fingertips feel by their drives' efforts (tip_pressure.hpp); all other links, and all
/// of a robot that tells no effort, are not valid.
v1::HandTouch touch_to_message(const Reading& reading, const model::HandModel& hand);

}  // namespace prehend::robot
