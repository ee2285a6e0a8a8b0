#pragma once

#include <string>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"
#include "services/planner/tools/hand_import/tree.hpp"

namespace prehend::planner {

/// The joints from a robot's root to a link.
struct ArmChain {
  std::string tip;                  // the link at its end
  std::vector<std::size_t> moving;  // indices of the joints that move, from the root
  std::vector<std::size_t> beside;  // those that move but are not on the way
  Pose X_LE = Pose::Identity();     // the tip in the frame of the last link that moves
};

/// To the tip; without one to the end of the longest chain, past all that is fixed to it. Fails
/// where no such link is there. robot: one tree.
Expected<ArmChain> find_chain(const Robot& robot, const std::string& tip);

}  // namespace prehend::planner
