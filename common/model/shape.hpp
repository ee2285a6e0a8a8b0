#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

namespace prehend::model {

enum class ShapeKind { unknown, cylinder, box, sphere, cone };

/// A primitive solid. O: the middle of the box that bounds it.
struct Shape {
  ShapeKind kind = ShapeKind::unknown;
  /// m. Cylinder: radius, radius, height (axis z). Box: depth (x), length (y), height (z).
  /// Sphere: radius three times. Cone: radius below, radius above, height (axis z); one
  /// radius may be 0. A cup is such a cone, too.
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

/// «cylinder, box, sphere or cone», for messages.
std::string shape_words();

/// True if the kind is known and every size is finite and positive; one radius of a cone may be 0.
bool is_valid(const Shape& shape);

/// Round about z: a cylinder, a cone. Turning such a one shows nothing.
bool is_upright_round(ShapeKind kind);

/// Of what is round about z: its radius at a height over O, m; beyond its ends that of the end.
double radius_at(const Shape& shape, double z);

/// Of a cylinder or cone: the wall's slope, how much the radius grows a metre of height.
double slope(const Shape& shape);

/// Where the mass is if it is spread evenly, in O, m.
Eigen::Vector3d centre_of_mass(const Shape& shape);

/// What is round as a cylinder of the same height and, in its middle, the same radius (a sphere:
/// as high as it is wide); a box as it is. For those who know no other shapes.
Shape like_known(const Shape& shape);

/// Half the edges of the box that bounds the shape along its own axes, m.
Eigen::Vector3d half_extents(const Shape& shape);

/// How far the shape reaches from O along a unit vector in O, m; of an unknown kind 0.
double extent(const Shape& shape, const Eigen::Vector3d& direction_O);

/// m³; of an unknown kind that of the sphere.
double volume(const Shape& shape);

/// Distance of p_O from the surface, m, negative inside. Exact outside and inside.
double signed_distance(const Shape& shape, const Eigen::Vector3d& p_O);

/// The one number that [Thesis, 5.3] gives the intelligent mapping: radius, or a box's depth. m.
double characteristic_size(const Shape& shape);

}  // namespace prehend::model
