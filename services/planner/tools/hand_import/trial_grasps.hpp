#pragma once

#include "common/model/hand_model.hpp"

namespace prehend::planner {

/// How many of six cylinders and boxes, as large as what stands on tables, the hand holds when it
/// closes from the posture `open` where its reach has people put it: cylinders from the side where
/// it finds room above the table, boxes from above; or 15 mm before or behind. In the physics, on
/// the table, lifted and shaken. Each counts by the share of three places, 8 mm apart, from which
/// it is held. Once it is clear that less than `needed` are held, the others are not tried. The
/// same answer each time, where it is not less.
double trial_grasps(const model::HandModel& hand, double needed = 0);

}  // namespace prehend::planner
