#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/grasping/planner.hpp"

namespace prehend::planner {

/// A grasp as JSON that `prehend grasp quality` reads: contacts, centre of mass, torque scale,
/// edges and wrenches, and all else that is known of it. SI units, frames in the keys.
nlohmann::ordered_json to_json(const grasping::Plan& plan, const grasping::PlannedGrasp& grasp);

/// What was planned, without the grasps, and how it ended.
nlohmann::ordered_json summary_json(const grasping::Plan& plan);

enum class Table { grasps, contacts, wrenches, dof };

/// A header and a line a row, each beginning with the number of the grasp in the plan.
std::string to_csv(const grasping::Plan& plan, Table table);

}  // namespace prehend::planner
