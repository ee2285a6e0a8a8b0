#pragma once

#include <cstdint>
#include <string>

#include "common/planning/plan.hpp"

namespace prehend::test {

/// The Puma with a hand, at the table as in the configuration's defaults.
planning::Robot puma_with(const std::string& hand);

/// Something to reach for on a table with four to six things on it, drawn from a seed: from home to
/// before one of them, from above, aslant or level, and then straight to it.
planning::Query drawn_reach(const planning::Robot& robot, std::uint64_t seed);

/// What `query` reached for, lifted by the hand of an arm in this posture, to somewhere else on the
/// same table, upright all the way.
planning::Query drawn_carry(const planning::Robot& robot, const planning::Query& query,
                            const arm::Joints& grasped, std::uint64_t seed);

/// Least distance that anything keeps along a trajectory from obstacles, m, looked at so often that
/// nothing moves by more than `step` between, by points on all surfaces and by none of the
/// planner's means. The table counts for hand and held object.
double min_gap(const planning::Robot& robot, const planning::Scene& scene,
               const planning::Trajectory& trajectory, double step);

}  // namespace prehend::test
