#pragma once

#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "services/planner/tools/hand_import/finding.hpp"

namespace prehend::planner {

/// The one finding of a file that is no robot.
UrdfFinding unreadable(Error error);

nlohmann::ordered_json to_json(const UrdfFinding& finding);
void print(const UrdfFinding& finding);  // on standard output, two lines

}  // namespace prehend::planner
