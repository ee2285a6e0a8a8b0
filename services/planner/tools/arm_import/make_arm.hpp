#pragma once

#include <string>
#include <vector>

#include "common/model/arm_model.hpp"
#include "services/planner/tools/hand_import/mesh.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// All that is missing or suspicious in a robot that shall be an arm, errors first. Without an
/// error make_arm() makes one of it. tip: the link at its end; empty: the last of its one chain.
std::vector<UrdfFinding> check_arm(const Robot& robot, const MeshReader& meshes,
                                   const std::string& tip = {});

/// An arm folder's two files and how they came about.
struct MadeArm {
  std::string urdf, toml;
  model::ArmModel model;             // that they load as
  std::vector<std::string> changes;  // what was done to the URDF, or assumed, a line each
};

/// Makes an arm of a robot: the chain from its root to the tip, whose frame becomes E and F. Joints
/// beside the chain stay at rest. Fails on robots with errors.
Expected<MadeArm> make_arm(const Robot& robot, const std::string& name, const MeshReader& meshes,
                           const std::string& tip = {});

}  // namespace prehend::planner
