#pragma once

#include <string>
#include <vector>

#include "services/planner/tools/hand_import/mesh.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// A robot made simple enough for a hand, and what was done to it, a line each.
struct Mended {
  Robot robot;
  std::vector<std::string> changes;
};

/// kind: what it shall be. Joins fixed links to their parents, replaces meshes by primitives, and
/// fills in what is missing: limits, masses, inertia, collision shapes. The robot has passed
/// check() without an error.
Expected<Mended> repair(const Robot& robot, const MeshReader& meshes,
                        const RobotKind& kind = hand_kind);

}  // namespace prehend::planner
