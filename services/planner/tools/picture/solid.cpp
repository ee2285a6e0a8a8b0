#include "services/planner/tools/picture/solid.hpp"

#include <cmath>
#include <numbers>

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr int around = 96;  // pieces of a circle
constexpr int rings = 48;   // pieces of half a circle

/// Points of a surface of revolution about z: radius and height, and the normal in that plane.
struct Profile {
  double r, z, nr, nz;
};

Vector3d turned(double radius, double height, int k) {
  const double angle = 2 * std::numbers::pi * k / around;
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

/// The strip between two circles.
void revolve(const Profile& low, const Profile& high, int paint, std::vector<Triangle>& made) {
  for (int k = 0; k < around; ++k) {
    const Vector3d a = turned(low.r, low.z, k), b = turned(low.r, low.z, k + 1);
    const Vector3d c = turned(high.r, high.z, k), d = turned(high.r, high.z, k + 1);
    const Vector3d na = turned(low.nr, low.nz, k), nb = turned(low.nr, low.nz, k + 1);
    const Vector3d nc = turned(high.nr, high.nz, k), nd = turned(high.nr, high.nz, k + 1);
    if (low.r > 0) made.push_back({{a, b, d}, {na, nb, nd}, paint});
    if (high.r > 0) made.push_back({{a, d, c}, {na, nd, nc}, paint});
  }
}

void box(const Vector3d& half, int paint, std::vector<Triangle>& made) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vector3d n = side * Vector3d::Unit(axis);
      const Vector3d u = half.cwiseProduct(Vector3d::Unit((axis + 1) % 3));
      const Vector3d v = half.cwiseProduct(Vector3d::Unit((axis + 2) % 3));
      const Vector3d middle = half[axis] * n;
      made.push_back({{middle - u - v, middle + u - v, middle + u + v}, {n, n, n}, paint});
      made.push_back({{middle - u - v, middle + u + v, middle - u + v}, {n, n, n}, paint});
    }
}

}  // namespace

std::vector<Triangle> surface_of(const model::Shape& shape, const Pose& X_WS, int paint) {
  std::vector<Triangle> made;
  const Vector3d half = model::half_extents(shape);
  switch (shape.kind) {
    case model::ShapeKind::box:
      box(half, paint, made);
      break;
    case model::ShapeKind::cylinder:
    case model::ShapeKind::cone: {
      const double below = shape.size.x(), above = shape.size.y(), rise = model::slope(shape);
      const double nr = 1 / std::hypot(1, rise), nz = -rise * nr;
      revolve({0, -half.z(), 0, -1}, {below, -half.z(), 0, -1}, paint, made);
      revolve({below, -half.z(), nr, nz}, {above, half.z(), nr, nz}, paint, made);
      revolve({above, half.z(), 0, 1}, {0, half.z(), 0, 1}, paint, made);
      break;
    }
    default:
      for (int i = 0; i < rings; ++i) {
        const double a = std::numbers::pi * i / rings, b = std::numbers::pi * (i + 1) / rings;
        revolve({half.x() * std::sin(a), -half.x() * std::cos(a), std::sin(a), -std::cos(a)},
                {half.x() * std::sin(b), -half.x() * std::cos(b), std::sin(b), -std::cos(b)}, paint,
                made);
      }
  }
  for (Triangle& triangle : made)
    for (int i = 0; i < 3; ++i) {
      triangle.p[i] = X_WS * triangle.p[i];
      triangle.n[i] = X_WS.linear() * triangle.n[i];
    }
  return made;
}

std::vector<Triangle> cone(const Vector3d& apex_W, const Vector3d& axis_W, double half_angle,
                           double length, int paint) {
  std::vector<Triangle> made;
  const double radius = length * std::tan(half_angle);
  const double nr = std::cos(half_angle), nz = -std::sin(half_angle);
  revolve({0, 0, nr, nz}, {radius, length, nr, nz}, paint, made);
  revolve({radius, length, 0, 1}, {0, length, 0, 1}, paint, made);
  const Pose X = make_pose(apex_W, Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis_W));
  for (Triangle& triangle : made)
    for (int i = 0; i < 3; ++i) {
      triangle.p[i] = X * triangle.p[i];
      triangle.n[i] = X.linear() * triangle.n[i];
    }
  return made;
}

}  // namespace prehend::planner
