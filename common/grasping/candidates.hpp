#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"

namespace prehend::grasping {

/// From where and with which posture a hand shall try to grasp. G: the hand's grasp frame.
struct Candidate {
  Pose X_OG = Pose::Identity();  // where G shall come to lie if nothing is in the way
  /// Along z of G, m: the hand comes closer than X_OG by this much, until it meets the object.
  double press_on = 0;
  std::string posture;       // of the hand, from which the preshape was made
  Eigen::VectorXd preshape;  // values of the DoFs before closing
};

/// The index-th candidate of a seed; depends on nothing else, so that any number of threads make
/// the same list. Sampled: the face that is approached, across which pair of faces the fingers
/// close (only pairs that fit into the hand's opening, if there are any), the turn about axes of
/// symmetry, the place along the faces, small errors of all of these, the stand-off, the named
/// posture, the DoFs that do not close (in a share `off_posture` of all), and how far the others
/// are closed beforehand.
Candidate sample_candidate(const model::HandModel& hand, const model::Shape& shape,
                           std::uint64_t seed, int index, double off_posture = 0.7);

/// Across the object's narrowest side, m.
double narrowest_width(const model::Shape& shape);

}  // namespace prehend::grasping
