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
                                                     {ShapeKind::sphere, "sphere"}});

/// Distance of a point from an axis-aligned box around the origin, in any number of dimensions.
template <class Vector>
double box_distance(const Vector& p, const Vector& half) {
  const Vector outside = p.cwiseAbs() - half;
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

}  // namespace

std::string_view to_string(ShapeKind kind) {
  return kind_names.name(kind);
}

std::optional<ShapeKind> shape_from_string(std::string_view name) {
  return kind_names.value(name);
}

bool is_valid(const Shape& shape) {
  if (shape.kind == ShapeKind::unknown) return false;
  return shape.size.allFinite() && shape.size.minCoeff() > 0;
}

Eigen::Vector3d half_extents(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::cylinder:
      return {shape.size.x(), shape.size.x(), 0.5 * shape.size.z()};
    case ShapeKind::box:
      return 0.5 * shape.size;
    case ShapeKind::sphere:
      return Eigen::Vector3d::Constant(shape.size.x());
    case ShapeKind::unknown:
      break;
  }
  return Eigen::Vector3d::Zero();
}

double signed_distance(const Shape& shape, const Eigen::Vector3d& p_O) {
  switch (shape.kind) {
    case ShapeKind::cylinder:
      // A cylinder is a rectangle in (distance from the axis, height).
      return box_distance(Eigen::Vector2d(p_O.head<2>().norm(), p_O.z()),
                          Eigen::Vector2d(shape.size.x(), 0.5 * shape.size.z()));
    case ShapeKind::box:
      return box_distance(p_O, Eigen::Vector3d(0.5 * shape.size));
    case ShapeKind::sphere:
    case ShapeKind::unknown:
      break;
  }
  return p_O.norm() - shape.size.x();
}

double characteristic_size(const Shape& shape) {
  return shape.size.x();
}

double volume(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::box:
      return s.prod();
    case ShapeKind::cylinder:
      return std::numbers::pi * s.x() * s.x() * s.z();
    default:
      return 4.0 / 3 * std::numbers::pi * s.x() * s.x() * s.x();
  }
}

}  // namespace prehend::model
