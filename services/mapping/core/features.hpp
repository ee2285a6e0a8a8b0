#pragma once

#include <Eigen/Core>
#include <array>

#include "common/base/error.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::mapping {

inline constexpr int feature_count = 9;

/// What a mapping sees of a hand: the tips of thumb, index and little finger in H [Thesis,
/// eq. 4.1], divided by the hand's scale: nine lengths in m, as of an average hand.
using Features = Eigen::Matrix<double, feature_count, 1>;

/// One fingertip as it came from the glove.
struct Fingertip {
  bool valid = false;
  Eigen::Vector3d p_HF = Eigen::Vector3d::Zero();  // m
};
using Fingertips = std::array<Fingertip, model::finger_count>;

/// Fails when a fingertip that is needed is missing, not finite or further from the back of the
/// hand than a finger is long (0.4 m), or when the scale is no hand's (0.5 to 2).
Expected<Features> features(const Fingertips& fingertips, double hand_scale);

/// How far thumb, index and little finger are bent, by the distance of their tips from H: 0 as in
/// HumanHand::open_posture(), 1 as in fist_posture(), not clamped.
Eigen::Vector3d bending(const Features& features);

}  // namespace prehend::mapping
