#pragma once

#include <filesystem>
#include <string>

#include "common/model/hand_model.hpp"
#include "services/planner/core/plan_book.hpp"

namespace prehend::planner {

/// As bytes within a file, and back. Reading refuses what was made for another hand or object, or
/// by another search, and what is not finite or has another number of DoF.
std::string encode(const Plan& plan, const std::string& made_for);
Expected<Plan> decode(const std::string& bytes, const model::HandModel& hand,
                      const grasping::Body& object, const std::string& made_for);

/// Plans of one hand in a folder, a sealed file an object. hand_folder: where hand.urdf and
/// hand.toml lie: plans for another version of them are not recalled. What cannot be read is not
/// there; what cannot be kept is warned of once. folder: empty: nothing is kept.
PlanStore plan_store(const std::filesystem::path& folder, const std::filesystem::path& hand_folder,
                     const model::HandModel& hand);

}  // namespace prehend::planner
