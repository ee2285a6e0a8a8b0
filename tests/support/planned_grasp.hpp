#pragma once

#include "common/model/grasp_candidates.hpp"
#include "common/model/placement.hpp"
#include "tests/support/hands.hpp"

namespace prehend::test {

/// The grasp frame of the Barrett hand that comes along this direction, fingers closing
/// horizontally.
inline Pose grasp_along(const model::Shape& shape, const Eigen::Vector3d& approach,
                        const Eigen::Vector3d& closing) {
  return *model::nearest_grasp(
      shape, make_pose(Eigen::Vector3d::Zero(), model::grasp_axes(approach, closing)),
      hand("barrett").reach());
}

/// A sound one of that hand, a little beside its approach.
inline model::GraspCandidate planned_grasp(const Pose& X_OG, double room = 0.75) {
  return {X_OG,
          X_OG * make_pose({0, 0.006, -0.004}),
          [] {
            Eigen::VectorXd preshape = hand("barrett").postures().at("open");
            preshape[0] = 0.2;
            return preshape;
          }(),
          Eigen::Vector4d(0.2, 1.1, 1.2, 1.3),
          Eigen::Vector4d(0, 1, 1, 1),
          room};
}

}  // namespace prehend::test
