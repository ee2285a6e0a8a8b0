#include "services/performer/core/reproduction/alike.hpp"

#include <array>
#include <numbers>

namespace prehend::performer {

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Orientation like the goal that is the least turn away from R.
Matrix3d nearest(const model::Shape& shape, const Matrix3d& goal, const Matrix3d& R) {
  if (shape.kind == model::ShapeKind::sphere) return R;
  Matrix3d best = goal;
  if (model::is_upright_round(shape.kind)) {
    // Of an axis up or down nothing shows, either; but who shows one upright means it.
    const auto turn = Eigen::Quaterniond::FromTwoVectors(R.col(2), goal.col(2));
    return turn.toRotationMatrix() * R;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Matrix3d other =
        goal * AngleAxisd(std::numbers::pi, Vector3d::Unit(axis)).toRotationMatrix();
    if (angle_between(other, R) < angle_between(best, R)) best = other;
  }
  return best;
}

}  // namespace

double visible_turn(const model::Shape& shape, const Matrix3d& R, const Matrix3d& goal) {
  return angle_between(nearest(shape, goal, R), R);
}

Pose nearest_alike(const model::Shape& shape, const Pose& goal, const Pose& X_WO) {
  return make_pose(goal.translation(), nearest(shape, goal.linear(), X_WO.linear()));
}

}  // namespace prehend::performer
