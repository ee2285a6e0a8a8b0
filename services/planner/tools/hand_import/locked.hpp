#pragma once

#include <string>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// It has a range, and that is one value.
bool is_locked(const RobotJoint& joint);

/// The robot with joints that cannot move made fixed, where they are: those whose range is one
/// value, those that follow by the factor 0, and all that follow these. changes: what was done, a
/// line each.
Robot without_locked(Robot robot, std::vector<std::string>& changes);

}  // namespace prehend::planner
