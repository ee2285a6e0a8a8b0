#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

namespace prehend::model {

enum class ShapeKind { unknown, cylinder, box, sphere };

/// A primitive solid centred on its own frame O.
struct Shape {
  ShapeKind kind = ShapeKind::unknown;
  /// m. Cylinder: radius, radius, height (axis z). Box: depth (x), length (y), height (z).
  /// Sphere: radius three times.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();

  bool operator==(const Shape&) const = default;
};

/// All points nearer than `radius` to a straight line.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();  // its ends, m
  double radius = 0;                                                         // m
};

std::string_view to_string(ShapeKind kind);
std::optional<ShapeKind> shape_from_string(std::string_view name);

/// True if the kind is known and every size is finite and positive.
bool is_valid(const Shape& shape);

/// Half the edges of the box that bounds the shape along its own axes, m.
Eigen::Vector3d half_extents(const Shape& shape);

/// m³; of an unknown kind that of the sphere.
double volume(const Shape& shape);

/// Distance of p_O from the surface, m, negative inside. Exact outside and inside.
double signed_distance(const Shape& shape, const Eigen::Vector3d& p_O);

/// The one number that [Thesis, 5.3] gives the intelligent mapping: radius, or a box's depth. m.
double characteristic_size(const Shape& shape);

}  // namespace prehend::model
