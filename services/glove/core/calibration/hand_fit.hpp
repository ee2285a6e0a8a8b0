#pragma once

#include <array>
#include <string_view>

#include "common/base/error.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// What a person shows to be calibrated.
enum class ShownPose { open, fist, pinch };
inline constexpr std::array shown_poses{ShownPose::open, ShownPose::fist, ShownPose::pinch};
std::string_view to_string(ShownPose pose);
/// What to tell the person.
std::string_view instruction(ShownPose pose);
/// The joint angles meant.
model::HumanPosture posture_of(ShownPose pose);

/// Fingertips in the frame of the sensor on the back of the hand; not valid: no sensor there.
using Fingertips = std::array<Fingertip, model::finger_count>;

/// Is this the pose at all? Says what is wrong where not. `before`: the fingertips of the open
/// hand.
Expected<void> check_pose(ShownPose pose, const Fingertips& tips, const Fingertips& open);

struct HandFit {
  double scale = 1, scale_sd = 0;                                  // and its standard deviation
  std::array<double, model::finger_count> fingers{1, 1, 1, 1, 1};  // as of model::HumanHand
  double residual = 0;  // m, RMS between fingertips shown and explained
};

/// The hand that explains best what was shown in the three poses (maximum a posteriori).
///
/// Unknown are the hand's scale, the length of each finger, where the sensor on the back of the
/// hand sits and how crooked, and the joint angles, since nobody shows a pose exactly. Minimised is
/// Σ |p_shown - p_model|²/σ² + Σ (x - x_expected)²/σ_x² by Gauss and Newton; scale_sd comes from
/// the inverse of the normal matrix. Needs three fingertips that are valid in every pose; fails on
/// fingertips that no hand explains.
Expected<HandFit> fit_hand(const std::array<Fingertips, shown_poses.size()>& shown);

}  // namespace prehend::glove
