#include "common/model/bounding_shape.hpp"

#include <algorithm>
#include <vector>

namespace prehend::model {
namespace {

using Eigen::Vector3d;

/// Vertices about the middle of the mesh: how far from the axis, and how high, 0 at the bottom
/// to 1.
struct Place {
  double radius, share;
};

/// Of the least cone with that radius below; `widest` if it would have to be wider.
double radius_above(const std::vector<Place>& places, double below, double widest) {
  double above = 0;
  for (const Place& place : places) {
    if (place.share < 1e-6) continue;
    above = std::max(above, below + (place.radius - below) / place.share);
  }
  return above <= widest * (1 + 1e-9) ? above : widest;
}

Shape bounding_cone(const std::vector<Place>& places, double height) {
  constexpr int steps = 64;
  double foot = 0, widest = 0;
  for (const Place& place : places) {
    widest = std::max(widest, place.radius);
    if (place.share < 1e-6) foot = std::max(foot, place.radius);
  }
  Shape best{ShapeKind::cone, {widest, widest, height}};
  for (int i = 0; i <= steps; ++i) {
    const double below = foot + (widest - foot) * i / steps;
    const Shape cone{ShapeKind::cone, {below, radius_above(places, below, widest), height}};
    const bool holds = std::all_of(places.begin(), places.end(), [&](const Place& place) {
      return place.radius <= radius_at(cone, (place.share - 0.5) * height) * (1 + 1e-9) + 1e-9;
    });
    if (holds && volume(cone) < volume(best)) best = cone;
  }
  return best;
}

}  // namespace

Shape bounding_shape(const Mesh& mesh) {
  constexpr double clearly = 0.98;  // of the volume of what came before
  const Eigen::AlignedBox3d box = bounds(mesh);
  const Vector3d middle = box.center(), size = box.sizes();
  std::vector<Place> places;
  double ball = 0;
  for (const Vector3d& vertex : mesh.vertices) {
    const Vector3d p = vertex - middle;
    ball = std::max(ball, p.norm());
    places.push_back({p.head<2>().norm(), p.z() / size.z() + 0.5});
  }
  const double round = std::max_element(places.begin(), places.end(), [](auto& a, auto& b) {
                         return a.radius < b.radius;
                       })->radius;
  Shape best{ShapeKind::box, size};
  for (const Shape& other :
       {Shape{ShapeKind::cylinder, {round, round, size.z()}},
        Shape{ShapeKind::sphere, Vector3d::Constant(ball)}, bounding_cone(places, size.z())})
    if (volume(other) < clearly * volume(best)) best = other;
  return best;
}

}  // namespace prehend::model
