#include "common/grasping/mesh_body.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

Expected<MeshSolid> solid_of(const model::Mesh& mesh, const PartsOptions& options) {
  const auto solid = model::measure(mesh);
  if (!solid) return tl::unexpected(solid.error());
  const Eigen::AlignedBox3d box = model::bounds(mesh);
  const Vector3d middle = box.center();
  auto parts = convex_parts(model::moved(mesh, -middle), options);
  if (!parts) return tl::unexpected(parts.error());
  double radius = 0;
  for (const Vector3d& vertex : mesh.vertices)
    radius = std::max(radius, (vertex - solid->centre).norm());
  return MeshSolid{{std::move(*parts), solid->centre - middle, solid->inertia, radius},
                   box.sizes()};
}

Expected<Body> load_body(const std::string& name, const std::filesystem::path& file, double mass,
                         const std::string& material, double scale, const PartsOptions& options) {
  const auto mesh = model::load_mesh(file, scale);
  if (!mesh) return tl::unexpected(mesh.error());
  auto made = solid_of(*mesh, options);
  if (!made) return fail(made.error().what, file.string(), made.error().hint);
  return Body{.name = name,
              .shape = {model::ShapeKind::box, made->size},
              .mass = mass,
              .material = material,
              .mesh = std::move(made->solid)};
}

SolidMesh cone_mesh(const model::Shape& cone) {
  SolidMesh made;
  made.parts.parts = {cone_corners(cone)};
  made.p_OC = model::centre_of_mass(cone);
  made.inertia_C = cone_inertia(cone);
  made.radius = analysis::torque_scale(cone);
  return made;
}

Body scaled(Body body, double factor) {
  body.shape.size *= factor;
  if (!body.mesh) return body;
  for (auto& part : body.mesh->parts.parts)
    for (Vector3d& corner : part) corner *= factor;
  body.mesh->p_OC *= factor;
  body.mesh->inertia_C *= factor * factor;
  body.mesh->radius *= factor;
  return body;
}

}  // namespace prehend::grasping
