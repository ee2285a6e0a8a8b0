#include "services/mapping/tools/judging/planned_grasps.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/table_grasps.hpp"

namespace prehend::mapping {

Candidates PlannedGrasps::search(const std::string& object, const model::Shape& shape) const {
  Candidates made{1, shape, {}};  // the track of seen_object()
  auto search = grasping::TableGraspSearch::create(hand_, objects_.seen(object, shape));
  if (!search) return made;
  const auto in_turn = [](std::size_t count, const auto& attempt) {
    for (std::size_t i = 0; i < count; ++i) attempt(i);
  };
  while (search->try_next(in_turn)) {
  }
  for (const grasping::SureGrasp& grasp : search->found())
    made.candidates.push_back({grasp.X_OG, grasp.grasp.X_OG, grasp.grasp.open, grasp.grasp.dof,
                               grasp.grasp.closing, grasp.room});
  return made;
}

Candidates PlannedGrasps::of(const BenchmarkTake& take) {
  constexpr double grain = 0.001;  // m, as in the planner
  model::Shape shape = take.recorded.seen_shape;
  shape.size = (shape.size / grain).array().round() * grain;
  const std::string& object = take.grasp.object;
  const std::string key = fmt::format("{} {:.3f} {:.3f} {:.3f}", object, shape.size.x(),
                                      shape.size.y(), shape.size.z());
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& known = entries_[key];
    if (!known) known = std::make_shared<Entry>();
    entry = known;
  }
  std::call_once(entry->once, [&] { entry->found = search(object, shape); });
  return entry->found;
}

Expected<Mapping> PlannedGrasps::mapping_for(const BenchmarkedHand& parts,
                                             const BenchmarkedMode& mode,
                                             const BenchmarkTake& take) {
  auto mapping = Mapping::create(parts.hand, parts.model, mapping_options(mode));
  if (!mapping || mode.mode != BenchmarkMode::planned) return mapping;
  if (auto told = mapping->on_candidates(of(take)); !told) return tl::unexpected(told.error());
  return mapping;
}

}  // namespace prehend::mapping
