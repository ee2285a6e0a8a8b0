#pragma once

#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::model {

/// The joints that move a link, from the base to it; as indices of hand.joints().
std::vector<int> joints_to(const HandModel& hand, int link);

}  // namespace prehend::model
