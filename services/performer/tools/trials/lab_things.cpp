#include "services/performer/tools/trials/lab_things.hpp"

#include <cstdint>
#include <utility>

#include "common/grasping/planned_candidates.hpp"

namespace prehend::performer {

Expected<std::vector<Thing>> LabThings::of(const model::Scene& scene) {
  std::vector<Thing> things;
  for (const model::PlacedObject& placed : scene.objects) {
    const grasping::Body* body = bodies_.find(placed.name);
    if (!body) return fail("is not in the catalogue", placed.name);
    Thing thing{*body, placed.X_WO, {}};
    if (is_planned_) {
      auto known = planned(*body);
      if (!known) return tl::unexpected(known.error());
      thing.planned = std::move(*known);
    }
    things.push_back(std::move(thing));
  }
  return things;
}

Expected<std::vector<model::GraspCandidate>> LabThings::planned(const grasping::Body& body) {
  if (asked_.insert(body.name).second) {
    const model::Shape shape = grasping::shape_to_plan(body.shape);
    auto found = grasping::planned_candidates(hand_, bodies_.seen(body.name, shape));
    const auto track = static_cast<std::uint32_t>(asked_.size());
    if (auto ok = known_.observe({track, shape, std::move(found), body.name}, hand_); !ok)
      return tl::unexpected(ok.error());
  }
  return known_.of(body.name, body.shape);
}

}  // namespace prehend::performer
