#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/grasping/convex_parts.hpp"
#include "common/grasping/world.hpp"
#include "common/model/mesh.hpp"

namespace prehend::grasping {

/// A mesh as what touches, of uniform density, and the box that bounds it.
struct MeshSolid {
  SolidMesh solid;
  Eigen::Vector3d size;  // of the box along the mesh's axes, m
};
Expected<MeshSolid> solid_of(const model::Mesh& mesh, const PartsOptions& options = {});

/// A body from an STL or OBJ file (see model::load_mesh). Its frame O lies in the middle of the box
/// that bounds it, along the file's axes; its shape is that box, for those who know nothing but
/// primitives. mass in kg, 0: does not move; material: of the friction table; scale: metres per
/// unit of the file.
Expected<Body> load_body(const std::string& name, const std::filesystem::path& file, double mass,
                         const std::string& material, double scale = 1,
                         const PartsOptions& options = {});

/// A cone as one convex part.
SolidMesh cone_mesh(const model::Shape& cone);

/// The same body, so many times as large, of the same mass.
Body scaled(Body body, double factor);

}  // namespace prehend::grasping
