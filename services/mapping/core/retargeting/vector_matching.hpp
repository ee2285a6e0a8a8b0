#pragma once

#include "services/mapping/core/retargeting/following_tips.hpp"

namespace prehend::mapping {

struct VectorMatchingOptions {
  double huber = 0.02;       // m, of a vector's miss, beyond which it counts linearly
  double smoothness = 4e-3;  // m/rad², of the change from the last posture
  int evaluations = 200;     // of the objective, at most
  double precision = 1e-9;   // m, of the objective, at which it is done
};

/// Vector retargeting as in AnyTeleop (Qin et al., RSS 2023, eq. 1) with the Huber loss of its
/// implementation's description:
///   min over q within limits of  mean_i huber(|v_i − f_i(q)|) + smoothness |q − q_before|²
/// where f_i(q) leads from the origin of the base to tip i and v_i is the same vector of the human
/// hand, scaled. Solved by NLopt's SLSQP (Kraft 1994) from `before`; the huber loss is divided by
/// its width, so that it is in m. vectors_G: a column a tip, in axes of G.
/// Precondition: finite values.
Eigen::VectorXd match_vectors(const FollowingTips& tips, const Eigen::Matrix3Xd& vectors_G,
                              const Eigen::VectorXd& before,
                              const VectorMatchingOptions& options = {});

}  // namespace prehend::mapping
