#pragma once

#include <vector>

#include "services/planner/tools/hand_import/mesh.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// All that is missing or suspicious in a robot of this kind, errors first. Without an error
/// `prehend hand add` can make a hand of it.
std::vector<UrdfFinding> check(const Robot& robot, const MeshReader& meshes,
                               const RobotKind& kind = hand_kind);

bool is_usable(const std::vector<UrdfFinding>& findings);

}  // namespace prehend::planner
