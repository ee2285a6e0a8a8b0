#pragma once

#include <vector>

#include "services/planner/tools/hand_import/anatomy.hpp"
#include "services/planner/tools/hand_import/skeleton.hpp"

namespace prehend::planner {

/// Which way each DoF closes the hand, and where it is open and a fist. A DoF closes if its joints
/// turn about nearly the same axis as the last joint of a finger (else it is abduction), towards
/// the side on which the tips come nearer to the palm, or slides tips towards each other.
std::vector<Anatomy::Dof> find_closing(const Skeleton& skeleton);

/// All DoFs that share of the way from open to a fist.
Eigen::VectorXd closed_by(const std::vector<Anatomy::Dof>& dofs, double share);

}  // namespace prehend::planner
