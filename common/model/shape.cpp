#include "common/model/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::model {
namespace {

constexpr auto kind_names = named_values<ShapeKind>({{ShapeKind::unknown, "unknown"},
                                                     {ShapeKind::cylinder, "cylinder"},
                                                     {ShapeKind::box, "box"},
                                                     {ShapeKind::sphere, "sphere"},
                                                     {ShapeKind::cone, "cone"}});

/// Distance of a point from an axis-aligned box around the origin, in any number of dimensions.
template <class Vector>
double box_distance(const Vector& p, const Vector& half) {
  const Vector outside = p.cwiseAbs() - half;
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double length = way.squaredNorm();  // 0 where a cone has its apex
  const double t = length > 0 ? std::clamp((p - a).dot(way) / length, 0.0, 1.0) : 0;
  return (p - a - t * way).norm();
}

/// A cone is a trapezoid in (distance from the axis, height).
double cone_distance(const Shape& shape, const Eigen::Vector2d& p) {
  const double half = 0.5 * shape.size.z(), below = shape.size.x(), above = shape.size.y();
  const Eigen::Vector2d foot(below, -half), rim(above, half);
  const double distance =
      std::min({distance_to_segment(p, foot, rim), distance_to_segment(p, {0, -half}, foot),
                distance_to_segment(p, {0, half}, rim)});
  const bool inside = std::abs(p.y()) <= half && p.x() <= radius_at(shape, p.y());
  return inside ? -distance : distance;
}

}  // namespace

std::string_view to_string(ShapeKind kind) {
  return kind_names.name(kind);
}

std::optional<ShapeKind> shape_from_string(std::string_view name) {
  return kind_names.value(name);
}

std::string shape_words() {
  return "cylinder, box, sphere or cone";
}

bool is_valid(const Shape& shape) {
  if (shape.kind == ShapeKind::unknown || !shape.size.allFinite()) return false;
  if (shape.kind != ShapeKind::cone) return shape.size.minCoeff() > 0;
  return shape.size.z() > 0 && shape.size.minCoeff() >= 0 && shape.size.head<2>().maxCoeff() > 0;
}

bool is_upright_round(ShapeKind kind) {
  return kind == ShapeKind::cylinder || kind == ShapeKind::cone;
}

double slope(const Shape& shape) {
  return shape.kind == ShapeKind::cone ? (shape.size.y() - shape.size.x()) / shape.size.z() : 0;
}

double radius_at(const Shape& shape, double z) {
  const double half = 0.5 * shape.size.z();
  return shape.size.x() + slope(shape) * (std::clamp(z, -half, half) + half);
}

Eigen::Vector3d centre_of_mass(const Shape& shape) {
  if (shape.kind != ShapeKind::cone) return Eigen::Vector3d::Zero();
  const double below = shape.size.x(), above = shape.size.y(), both = below * above;
  const double parts = below * below + both + above * above;
  return {0, 0, shape.size.z() * (above * above - below * below) / (4 * parts)};
}

Shape like_known(const Shape& shape) {
  if (shape.kind == ShapeKind::cone) {
    const double radius = radius_at(shape, 0);
    return {ShapeKind::cylinder, {radius, radius, shape.size.z()}};
  }
  if (shape.kind == ShapeKind::sphere)
    return {ShapeKind::cylinder, {shape.size.x(), shape.size.x(), 2 * shape.size.x()}};
  return shape;
}

Eigen::Vector3d half_extents(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::cylinder:
      return {shape.size.x(), shape.size.x(), 0.5 * shape.size.z()};
    case ShapeKind::box:
      return 0.5 * shape.size;
    case ShapeKind::sphere:
      return Eigen::Vector3d::Constant(shape.size.x());
    case ShapeKind::cone: {
      const double widest = shape.size.head<2>().maxCoeff();
      return {widest, widest, 0.5 * shape.size.z()};
    }
    case ShapeKind::unknown:
      break;
  }
  return Eigen::Vector3d::Zero();
}

double extent(const Shape& shape, const Eigen::Vector3d& direction_O) {
  const Eigen::Vector3d& size = shape.size;
  const double flat = direction_O.head<2>().norm(), up = 0.5 * direction_O.z() * size.z();
  switch (shape.kind) {
    case ShapeKind::box:
      return 0.5 * direction_O.cwiseAbs().dot(size);
    case ShapeKind::sphere:
      return size.x();
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      // One of its two rims is there.
      return std::max(size.x() * flat - up, size.y() * flat + up);
    case ShapeKind::unknown:
      break;
  }
  return 0;
}

double signed_distance(const Shape& shape, const Eigen::Vector3d& p_O) {
  switch (shape.kind) {
    case ShapeKind::cylinder:
      // A cylinder is a rectangle in (distance from the axis, height).
      return box_distance(Eigen::Vector2d(p_O.head<2>().norm(), p_O.z()),
                          Eigen::Vector2d(shape.size.x(), 0.5 * shape.size.z()));
    case ShapeKind::box:
      return box_distance(p_O, Eigen::Vector3d(0.5 * shape.size));
    case ShapeKind::cone:
      return cone_distance(shape, {p_O.head<2>().norm(), p_O.z()});
    case ShapeKind::sphere:
    case ShapeKind::unknown:
      break;
  }
  return p_O.norm() - shape.size.x();
}

double characteristic_size(const Shape& shape) {
  return shape.kind == ShapeKind::cone ? radius_at(shape, 0) : shape.size.x();
}

double volume(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::box:
      return s.prod();
    case ShapeKind::cylinder:
      return std::numbers::pi * s.x() * s.x() * s.z();
    case ShapeKind::cone:
      return std::numbers::pi / 3 * s.z() * (s.x() * s.x() + s.x() * s.y() + s.y() * s.y());
    default:
      return 4.0 / 3 * std::numbers::pi * s.x() * s.x() * s.x();
  }
}

}  // namespace prehend::model
