#pragma once

#include "common/model/grasp_taxonomy.hpp"
#include "services/demonstration/core/showing/fingers.hpp"

namespace prehend::demonstration {

/// What one hand does otherwise than another one when both grasp in the same way.
struct Manner {
  model::HumanPosture posture = model::HumanPosture::Zero();  // rad, more than is usual
  Eigen::Vector3d place_H = Eigen::Vector3d::Zero();          // m, of the object, off the usual
  double oblique = 0;                                         // rad, of a bar in the palm
  double reach_round = 0;                                     // rad, of fingers around something
  double row = 1;                                             // how far apart fingers stand
  double curl = 0.4;                                          // closure of fingers that are idle
  Bending bending;
};

/// The thumb always does.
bool takes_part(const model::GraspClass& kind, model::Finger finger);

/// How a hand holds an object in this way: wrapped into the palm, between fingertips, or between
/// the thumb and the index finger's side, as the taxonomy says.
Held holding(const model::HumanHand& hand, const model::GraspClass& kind, const model::Shape& shape,
             const Manner& manner);

}  // namespace prehend::demonstration
