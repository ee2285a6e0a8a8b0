#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/shell.hpp"
#include "idl/Planning.h"

namespace prehend::performer {

/// What prehend-planner says on grasp/candidates for the hand of this name, if one is there. In the
/// thread of the shell, which must outlive it.
class PlannerEars {
 public:
  PlannerEars(service::Shell& shell, std::string hand_name);
  PlannerEars(const PlannerEars&) = delete;
  PlannerEars& operator=(const PlannerEars&) = delete;

  /// The newest of each object. What is not of this kind of hand or nonsense is dropped and
  /// counted.
  model::CandidateBook of(const model::HandModel& hand) const;

 private:
  service::Shell& shell_;
  std::string hand_name_;
  // As they came, by track: of which kind the hand is only the robot says.
  std::map<std::uint32_t, v2::GraspCandidates> heard_;
};

}  // namespace prehend::performer
