#pragma once

#include <prehend/model/hand_model.hpp>
#include <string>
#include <vector>

#include "check.hpp"
#include "mend.hpp"

namespace prehend::hands {

/// A hand folder's two files and how they came about.
struct MadeHand {
  std::string urdf, toml;
  model::HandModel model;  // that they load as
  std::vector<Finding> findings;
  std::vector<std::string> changes;  // what was done to the URDF, a line each
  bool opposed = true;               // fingers that move towards each other were found
};

/// Makes a hand of a checked robot. Fails on robots with errors.
Expected<MadeHand> make_hand(const Robot& robot, const std::string& name, const MeshReader& meshes);

}  // namespace prehend::hands
