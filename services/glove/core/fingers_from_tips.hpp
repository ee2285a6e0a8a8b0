#pragma once

#include <array>
#include <optional>

#include "common/model/human_hand.hpp"

namespace prehend::glove {

/// Joint angles that bring the fingertips of a hand as near to given points (in H, m) as its
/// joints allow, by damped least squares from `start`, and from elsewhere where that gets stuck;
/// fingers without a point stay there. Where many postures reach a point, it is the one near
/// `start`.
model::HumanPosture fingers_from_tips(
    const model::HumanHand& hand,
    const std::array<std::optional<Eigen::Vector3d>, model::finger_count>& p_HF,
    const model::HumanPosture& start);

}  // namespace prehend::glove
