#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/error.hpp"
#include "common/model/grasp_candidates.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

namespace prehend::mapping {

/// The grasps that prehend-planner finds for the objects of takes, as they are seen there. Each is
/// searched once, whoever asks first; several threads may ask. Keeps references to the hand and the
/// objects.
class PlannedGrasps {
 public:
  PlannedGrasps(const model::HandModel& hand, const grasping::CatalogueBodies& objects)
      : hand_(hand), objects_(objects) {}

  /// The mapping of this mode as it is before the take: `planned` has heard of all grasps.
  Expected<Mapping> mapping_for(const BenchmarkedHand& parts, const BenchmarkedMode& mode,
                                const BenchmarkTake& take);

 private:
  struct Entry {
    std::once_flag once;
    model::GraspCandidates found;
  };
  model::GraspCandidates of(const BenchmarkTake& take);
  model::GraspCandidates search(const std::string& object, const model::Shape& shape) const;

  const model::HandModel& hand_;
  const grasping::CatalogueBodies& objects_;
  std::mutex mutex_;  // of the entries
  std::map<std::string, std::shared_ptr<Entry>> entries_;
};

}  // namespace prehend::mapping
