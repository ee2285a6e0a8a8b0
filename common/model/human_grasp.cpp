#include "common/model/human_grasp.hpp"

#include <cmath>

namespace prehend::model {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Before the object's size is taken into account.
Pose intended_grasp(const Shape& shape, const Pose& X_WO, const Demonstrator& person) {
  Matrix3d R_WG;
  if (shape.kind == ShapeKind::box && shape.size.z() >= person.reach.clearance) {
    // Across the narrower side.
    const Vector3d across = X_WO.linear().col(shape.size.x() <= shape.size.y() ? 0 : 1);
    const Vector3d closing =
        (Vector3d(across.x(), across.y(), 0).normalized()) * (across.y() < 0 ? -1.0 : 1.0);
    R_WG = grasp_axes(-Vector3d::UnitZ(), closing);
  } else {
    const Vector3d toward(-std::cos(person.grasp_yaw), -std::sin(person.grasp_yaw), 0);
    R_WG = grasp_axes(toward, toward.cross(Vector3d::UnitZ()));
  }
  return X_WO.inverse() * make_pose(X_WO.translation(), R_WG);
}

}  // namespace

std::optional<Pose> human_grasp(const Shape& shape, const Pose& X_WO, const Demonstrator& person) {
  return nearest_grasp(shape, intended_grasp(shape, X_WO, person), person.reach);
}

}  // namespace prehend::model
