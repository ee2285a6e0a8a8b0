#pragma once

#include "common/grasping/hold_test.hpp"

namespace prehend::grasping {

/// A hand over an object that stands on the table, and how it closes; DoF values, rad or m.
struct TableGrasp {
  Pose X_OG;
  Eigen::VectorXd open, dof;  // before it closes, and where its fingers stop
  Eigen::VectorXd closing;    // of each DoF: +1, -1, which way it presses, 0 if it rests
  double epsilon = -1;        // of the contacts; -1 without force closure
};

/// Whether the object is held when the fingers close as the mapping has them close: from the open
/// hand, in proportion, so that they arrive together, then squeezed; and then the hold test. Not
/// held is what the open hand reaches into, and what the fingers shove or topple.
bool held_on_table(const model::HandModel& hand, const Body& object, const TableGrasp& grasp,
                   const HoldOptions& hold = {});

}  // namespace prehend::grasping
