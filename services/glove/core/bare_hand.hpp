#pragma once

#include <array>
#include <optional>

#include "common/model/human_hand.hpp"
#include "services/glove/core/frame.hpp"

namespace prehend::glove {

/// The 21 landmarks of a hand, m: wrist; of the thumb CMC, MCP, IP, tip; of index, middle, ring and
/// little finger MCP, PIP, DIP, tip.
using Landmarks = std::array<Eigen::Vector3d, 21>;

/// What cameras tell of a hand without sensors, in any frame R.
struct BareHand {
  bool left = false;
  Eigen::Vector3d x_R, z_R;   // towards the fingers; out of the back of the hand; any length
  Eigen::Vector3d knuckle_R;  // of the middle finger, m
  std::array<Eigen::Vector3d, model::finger_count> tip_R, before_R;  // tip, joint before it, m
};

/// Wrist and knuckles tell where the hand points and where its back is.
BareHand bare_hand(const Landmarks& p_R, bool left);

/// Its image in the plane through R's origin with this normal (unit). What left says stays, as it
/// tells where the hand came from.
void mirror(BareHand& hand, const Eigen::Vector3d& normal_R);

/// A glove with sensors on the back of the hand and on all five fingertips of a right hand. In H
/// its middle knuckle lies where that of the hand model lies. The hand is at X_TH or, without one,
/// where the points are, R being T. Nothing where the hand's directions say nothing.
std::optional<Frame> sensors_on(const BareHand& hand, double hand_scale,
                                const std::optional<Pose>& X_TH);

/// The landmarks of the hand model, in H.
Landmarks landmarks_of(const model::HumanHand& hand, const model::HumanPosture& posture);

}  // namespace prehend::glove
