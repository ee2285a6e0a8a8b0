#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/grasping/convex_parts.hpp"
#include "common/grasping/world.hpp"

namespace prehend::grasping {

/// A body from an STL or OBJ file (see model::load_mesh), of uniform density. Its frame O lies in
/// the centre of mass, along the file's axes; its shape is the box that bounds the mesh, for those
/// who know nothing but primitives. mass in kg, 0: does not move; material: of the friction table;
/// scale: metres per unit of the file.
Expected<Body> load_body(const std::string& name, const std::filesystem::path& file, double mass,
                         const std::string& material, double scale = 1,
                         const PartsOptions& options = {});

}  // namespace prehend::grasping
