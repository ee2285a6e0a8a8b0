#pragma once

#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "services/planner/tools/grasp/quality_file.hpp"

namespace prehend::planner {

/// What contacts tell beyond their wrenches, as keys for the document of `prehend grasp quality`:
/// L∞, grasp map and internal forces; the grip against a load; skewness; and, when the file names a
/// hand, its manipulability and its least torques against the load. Up to 50 contacts; of more only
/// the grasp map. Fails when the hand is not there or does not fit the contacts.
Expected<nlohmann::ordered_json> contact_measures(const GraspFile& grasp);

}  // namespace prehend::planner
