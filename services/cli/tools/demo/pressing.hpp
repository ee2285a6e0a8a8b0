#pragma once

#include <optional>

#include "common/model/hand_model.hpp"

namespace prehend::cli {

/// Where an open hand touches a standing box that it comes to from +x, as a person lays it who will
/// press: fingers forward and palm to the box, then turned, by 35° each way at most, until it lies
/// on the box with parts all round the line along which it is pushed. That line goes along x
/// through the origin of its grasp frame G, `above` the middle of the box, m. Returns X_OG, within
/// 2 mm; none of a hand that passes by.
std::optional<Pose> pressing_pose(const model::HandModel& hand, const model::Shape& box,
                                  double above);

}  // namespace prehend::cli
