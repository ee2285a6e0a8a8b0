#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// Points of a mesh that would be a robot's link if it were in millimetres, and is far too large as
/// it is, become m. True: they did.
inline bool taken_as_millimetres(std::vector<Eigen::Vector3d>& points, const RobotKind& kind) {
  Eigen::Vector3d low = points.at(0), high = low;
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double size = (high - low).maxCoeff();
  constexpr double least = 2;  // mm, of what a link is made of
  if (!(size > 2 * kind.max_link) || size < least || size > 1e3 * kind.max_link) return false;
  for (Eigen::Vector3d& p : points) p *= 1e-3;
  return true;
}

}  // namespace prehend::planner
