#pragma once

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::fuzz {

/// What must hold of every robot that was read, however it came: findings say what, where and the
/// mend; if a hand is made of it, that is sound and has every collision shape. True: one was made.
bool check_and_make(const planner::Robot& robot);

}  // namespace prehend::fuzz
