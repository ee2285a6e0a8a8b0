#include "services/planner/tools/hand_import/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr int grid = 10;

/// -1 .. 1 in steps.
double step(int i) {
  return 2.0 * i / grid - 1;
}

double deepest(const model::Shape& A, const Pose& X_WA, const model::Shape& B, const Pose& X_WB) {
  const Pose X_BA = X_WB.inverse() * X_WA;
  double depth = -1e9;
  for (const Vector3d& p_A : surface_points(A))
    depth = std::max(depth, -model::signed_distance(B, X_BA * p_A));
  return depth;
}

}  // namespace

std::vector<Vector3d> surface_points(const model::Shape& shape) {
  std::vector<Vector3d> points;
  const Vector3d half = model::half_extents(shape);
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      const double u = step(i), v = step(j), angle = std::numbers::pi * u;
      switch (shape.kind) {
        case model::ShapeKind::box:
          for (const double side : {-1.0, 1.0}) {
            points.push_back(half.cwiseProduct(Vector3d(side, u, v)));
            points.push_back(half.cwiseProduct(Vector3d(u, side, v)));
            points.push_back(half.cwiseProduct(Vector3d(u, v, side)));
          }
          break;
        case model::ShapeKind::cylinder:
        case model::ShapeKind::cone: {
          const Vector3d rim(half.x() * std::cos(angle), half.x() * std::sin(angle), 0);
          points.push_back(rim + v * half.z() * Vector3d::UnitZ());
          for (const double side : {-1.0, 1.0})
            points.push_back(0.5 * (v + 1) * rim + side * half.z() * Vector3d::UnitZ());
          break;
        }
        default: {
          const double height = v, ring = std::sqrt(std::max(0.0, 1 - v * v));
          points.push_back(half.x() *
                           Vector3d(ring * std::cos(angle), ring * std::sin(angle), height));
        }
      }
    }
  return points;
}

double overlap(const model::Shape& A, const Pose& X_WA, const model::Shape& B, const Pose& X_WB) {
  const double apart = (X_WA.translation() - X_WB.translation()).norm() -
                       model::half_extents(A).norm() - model::half_extents(B).norm();
  if (apart > 0) return -apart;
  return std::max(deepest(A, X_WA, B, X_WB), deepest(B, X_WB, A, X_WA));
}

}  // namespace prehend::planner
