#include "common/grasping/mesh_body.hpp"

#include <algorithm>

namespace prehend::grasping {

Expected<Body> load_body(const std::string& name, const std::filesystem::path& file, double mass,
                         const std::string& material, double scale, const PartsOptions& options) {
  const auto mesh = model::load_mesh(file, scale);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto solid = model::measure(*mesh);
  if (!solid) return tl::unexpected(solid.error());
  SolidMesh made;
  made.p_FO = solid->centre;
  made.inertia_O = solid->inertia;
  made.surface = model::moved(*mesh, -solid->centre);
  auto parts = convex_parts(made.surface, options);
  if (!parts) return fail(parts.error().what, file.string(), parts.error().hint);
  made.parts = std::move(*parts);
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : made.surface.vertices) {
    made.radius = std::max(made.radius, vertex.norm());
    half = half.cwiseMax(vertex.cwiseAbs());
  }
  return Body{.name = name,
              .shape = {model::ShapeKind::box, 2 * half},
              .mass = mass,
              .material = material,
              .mesh = std::move(made)};
}

}  // namespace prehend::grasping
