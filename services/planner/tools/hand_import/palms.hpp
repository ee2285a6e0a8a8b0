#pragma once

#include <string>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// The palms of a robot: links on which chains of moving links branch, near each other. A robot of
/// one chain has its root. Empty: its links form no tree.
std::vector<std::string> palms(const Robot& robot);

/// The hand of a robot. palm: the link where it begins, or empty: the only one there is. What lies
/// before the palm is left out where it is an arm; a wrist is kept. Findings of the robot say so,
/// and which palms there are to choose from where there are several.
Robot hand_of(Robot robot, const std::string& palm = {});

}  // namespace prehend::planner
