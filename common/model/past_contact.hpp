#pragma once

#include <Eigen/Core>

#include "common/model/hand_model.hpp"

namespace prehend::model {

/// Fingers that have closed on an object go on by at most this, rad, until something stops them.
inline constexpr double full_follow_through = 0.5;

/// The posture `dof` with its closing fingers past contact: the one that has come farthest from
/// `open` by `angle`, rad or what stands for it where a jaw slides, the others in proportion, so
/// that on the straight way there all of them arrive at the object together; at most the hand's
/// limits. closing: of each DoF: +1 or -1, which way it closes, 0 if it rests. All of the hand's
/// number of DoF.
Eigen::VectorXd past_contact(const HandModel& hand, const Eigen::VectorXd& open,
                             const Eigen::VectorXd& dof, const Eigen::VectorXd& closing,
                             double angle);

}  // namespace prehend::model
