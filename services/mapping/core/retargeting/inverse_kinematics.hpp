#pragma once

#include "services/mapping/core/retargeting/following_tips.hpp"

namespace prehend::mapping {

struct InverseKinematicsOptions {
  int iterations = 40;    // at most
  double damping = 0.01;  // m/rad; the least, where all goes well
  double nearer = 1e-5;   // m, of the fingertips in an iteration: less, and it is done
  /// Weight of staying at the start, (m/rad)²: decides what the fingertips leave open.
  double stay = 1e-7;
};

/// The values of the DoFs, within the hand's limits, that bring the tips nearest to p_GT (least
/// squares), by damped least squares from `start` (Wampler 1986; the damping follows Levenberg and
/// Marquardt's rule). A DoF that would leave its limit stays there while the others go on. The
/// nearest minimum to the start, so that a warm start gives a smooth answer.
/// Precondition: finite values, one column a tip.
Eigen::VectorXd reach(const FollowingTips& tips, const Eigen::Matrix3Xd& p_GT,
                      const Eigen::VectorXd& start, const InverseKinematicsOptions& options = {});

}  // namespace prehend::mapping
