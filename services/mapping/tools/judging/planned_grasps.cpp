#include "services/mapping/tools/judging/planned_grasps.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/planned_candidates.hpp"

namespace prehend::mapping {

model::GraspCandidates PlannedGrasps::search(const std::string& object,
                                             const model::Shape& shape) const {
  // The track of seen_object().
  return {1, shape, grasping::planned_candidates(hand_, objects_.seen(object, shape)), object};
}

model::GraspCandidates PlannedGrasps::of(const BenchmarkTake& take) {
  const model::Shape shape = grasping::shape_to_plan(take.recorded.seen_shape);
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
