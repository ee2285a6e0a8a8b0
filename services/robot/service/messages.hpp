#pragma once

#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "idl/Robot.h"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// What a robot measured, as the simulation says it. Joints that no encoder sees are where their
/// drive is; what a drive presses with is said of the joint that leads it.
v1::HandState to_message(const Reading& reading, const model::HandModel& hand, const Pose& X_WB);

}  // namespace prehend::robot
