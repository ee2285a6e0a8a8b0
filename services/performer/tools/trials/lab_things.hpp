#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/scene.hpp"
#include "services/performer/core/rehearsal/rehearsal.hpp"

namespace prehend::performer {

/// The things of labs of one hand, as a performer knows them there.
class LabThings {
 public:
  /// planned: prehend-planner is there, and has searched for all that it sees. Keeps references.
  LabThings(const model::HandModel& hand, const grasping::CatalogueBodies& bodies, bool planned)
      : hand_(hand), bodies_(bodies), is_planned_(planned) {}

  /// Fails on an object that is not in the catalogue.
  Expected<std::vector<Thing>> of(const model::Scene& scene);

 private:
  /// Each object is searched once.
  Expected<std::vector<model::GraspCandidate>> planned(const grasping::Body& body);

  const model::HandModel& hand_;
  const grasping::CatalogueBodies& bodies_;
  bool is_planned_;
  model::CandidateBook known_;
  std::set<std::string> asked_;
};

}  // namespace prehend::performer
