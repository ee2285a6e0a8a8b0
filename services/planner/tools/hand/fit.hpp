#pragma once

#include <vector>

#include "common/grasping/world.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::planner {

/// Least and greatest distance between the two fingertips that are farthest apart, m, over 4000
/// random postures; of one finger, between its tip and the base.
struct Span {
  double least = 0, greatest = 0;
};
Span fingertip_span(const model::HandModel& hand);

/// Three bodies for a trial: of those that fit into the hand's opening, one of each shape first;
/// the narrowest if fewer fit.
std::vector<grasping::Body> trial_bodies(const std::vector<grasping::Body>& bodies, double opening);

}  // namespace prehend::planner
