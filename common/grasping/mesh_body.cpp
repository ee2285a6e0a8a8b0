#include "common/grasping/mesh_body.hpp"

#include <algorithm>
#include <utility>

#include "common/analysis/wrench_space.hpp"
#include "common/grasping/surface.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;

/// Of a cone per kg, about its centre of mass: integrals of discs whose radius grows with height.
Eigen::Matrix3d cone_inertia(const model::Shape& cone) {
  const double a = cone.size.x(), b = cone.size.y(), h = cone.size.z();
  const double area = a * a + a * b + b * b;
  const double about_axis =
      0.3 * (a * a * a * a + a * a * a * b + a * a * b * b + a * b * b * b + b * b * b * b) / area;
  const double from_bottom = model::centre_of_mass(cone).z() + 0.5 * h;
  const double along_axis =
      0.1 * h * h * (a * a + 3 * a * b + 6 * b * b) / area - from_bottom * from_bottom;
  const double across = 0.5 * about_axis + along_axis;
  return Vector3d(across, across, about_axis).asDiagonal();
}

/// How far the corner that is farthest from the centre of mass is, m.
double farthest(const SolidMesh& mesh) {
  double radius = 0;
  for (const auto& part : mesh.parts.parts)
    for (const Vector3d& corner : part) radius = std::max(radius, (corner - mesh.p_OC).norm());
  return radius;
}

}  // namespace

Expected<SolidMesh> solid_of(const model::Mesh& mesh, const PartsOptions& options) {
  const auto solid = model::measure(mesh);
  if (!solid) return tl::unexpected(solid.error());
  const Vector3d middle = model::bounds(mesh).center();
  auto parts = convex_parts(model::moved(mesh, -middle), options);
  if (!parts) return tl::unexpected(parts.error());
  SolidMesh made{std::move(*parts), solid->centre - middle, solid->inertia, 0};
  made.radius = farthest(made);
  return made;
}

SolidMesh cone_mesh(const model::Shape& cone) {
  SolidMesh made;
  made.parts.parts = {cone_corners(cone)};
  made.p_OC = model::centre_of_mass(cone);
  made.inertia_C = cone_inertia(cone);
  made.radius = analysis::torque_scale(cone);
  return made;
}

SolidMesh scaled(SolidMesh mesh, const Vector3d& factor) {
  for (auto& part : mesh.parts.parts)
    for (Vector3d& corner : part) corner = corner.cwiseProduct(factor);
  mesh.p_OC = mesh.p_OC.cwiseProduct(factor);
  // Second moments scale along their axes; inertia is the trace of them less themselves.
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d moments = 0.5 * mesh.inertia_C.trace() * one - mesh.inertia_C;
  moments = factor.asDiagonal() * moments * factor.asDiagonal();
  mesh.inertia_C = moments.trace() * one - moments;
  mesh.radius = farthest(mesh);
  return mesh;
}

Body scaled(Body body, double factor) {
  body.shape.size *= factor;
  if (body.mesh) body.mesh = scaled(std::move(*body.mesh), Vector3d::Constant(factor));
  return body;
}

}  // namespace prehend::grasping
