#pragma once

#include <cmath>

#include "common/model/hand_model.hpp"

namespace prehend::model {

/// What the drives of each DoF have, all its joints together: N m of the joint that leads it, or N.
inline Eigen::VectorXd max_effort(const HandModel& hand) {
  Eigen::VectorXd effort = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(hand.dofs().size()));
  for (const HandJoint& joint : hand.joints())
    effort[joint.dof] += std::abs(joint.multiplier) * joint.max_torque;
  return effort;
}

}  // namespace prehend::model
