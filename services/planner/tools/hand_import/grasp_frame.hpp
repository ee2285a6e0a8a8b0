#pragma once

#include <vector>

#include "services/planner/tools/hand_import/anatomy.hpp"
#include "services/planner/tools/hand_import/skeleton.hpp"

namespace prehend::planner {

/// Where a hand grasps, from how its tips move while they close.
struct GraspFrame {
  Pose X_BG = Pose::Identity();
  model::Reach reach;
  bool opposed = true;  // there are fingers that move towards each other
};

GraspFrame find_grasp_frame(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs);

/// How far tips and palm reach beyond the origin of G: the clearance and the width of the reach.
void find_clearance(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs,
                    const Pose& X_BG, model::Reach& reach);

}  // namespace prehend::planner
