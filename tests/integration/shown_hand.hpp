#pragma once

#include <array>

#include "common/model/human_hand.hpp"
#include "idl/Glove.h"

namespace prehend::integration {

/// How far each finger is closed, thumb first, 0 to 1.
using Closure = std::array<double, model::finger_count>;

/// What a glove says now of an average hand in this posture, 0.4 m above the table; every finger
/// has a sensor.
v1::HandPosture shown_hand(const Closure& closure, std::uint64_t frame);

}  // namespace prehend::integration
