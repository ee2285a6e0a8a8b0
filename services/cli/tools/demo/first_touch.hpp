#pragma once

#include "common/model/hand_model.hpp"

namespace prehend::cli {

/// An open hand comes to a standing box from +x, its fingers forward, as a person's does who will
/// press it. Returns how far below the surface the origin of its grasp frame is when the hand
/// touches the box first, m; negative: outside. above: of the middle, where it comes, m. Within 2
/// mm; a hand that passes by touches nothing: infinity.
double first_touch(const model::HandModel& hand, const model::Shape& box, double above);

}  // namespace prehend::cli
