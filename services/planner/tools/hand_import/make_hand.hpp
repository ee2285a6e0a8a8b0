#pragma once

#include <string>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "services/planner/tools/hand_import/opposition.hpp"
#include "services/planner/tools/hand_import/repair.hpp"

namespace prehend::planner {

/// A hand folder's two files and how they came about.
struct MadeHand {
  std::string urdf, toml;
  model::HandModel model;  // that they load as
  std::vector<UrdfFinding> findings;
  std::vector<std::string> changes;  // what was done to the URDF, a line each
  bool opposed = true;               // fingers that move towards each other were found
};

/// Makes a hand of a checked robot. Fails on robots with errors.
Expected<MadeHand> make_hand(const Robot& robot, const std::string& name, const MeshReader& meshes,
                             const SearchEffort& effort = {});

}  // namespace prehend::planner
