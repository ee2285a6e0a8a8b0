#include "common/grasping/planned_candidates.hpp"

#include "common/grasping/table_grasps.hpp"

namespace prehend::grasping {

model::Shape shape_to_plan(const model::Shape& seen) {
  constexpr double grain = 0.001;  // m
  return {seen.kind, (seen.size / grain).array().round() * grain};
}

std::vector<model::GraspCandidate> planned_candidates(const model::HandModel& hand,
                                                      const Body& object) {
  auto search = TableGraspSearch::create(hand, object);
  if (!search) return {};
  const auto in_turn = [](std::size_t count, const auto& attempt) {
    for (std::size_t i = 0; i < count; ++i) attempt(i);
  };
  while (search->try_next(in_turn)) {
  }
  std::vector<model::GraspCandidate> made;
  for (const SureGrasp& found : search->found())
    made.push_back({found.X_OG, found.grasp.X_OG, found.grasp.open, found.grasp.dof,
                    found.grasp.closing, found.room, found.follow_through});
  return made;
}

}  // namespace prehend::grasping
