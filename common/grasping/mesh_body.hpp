#pragma once

#include "common/base/error.hpp"
#include "common/grasping/convex_parts.hpp"
#include "common/grasping/world.hpp"
#include "common/model/mesh.hpp"

namespace prehend::grasping {

/// A mesh as what touches, of uniform density. Fails when the mesh encloses no volume or cannot be
/// cut into convex parts.
Expected<SolidMesh> solid_of(const model::Mesh& mesh, const PartsOptions& options = {});

/// A cone as one convex part.
SolidMesh cone_mesh(const model::Shape& cone);

/// The same, so many times as large along each axis of O.
SolidMesh scaled(SolidMesh mesh, const Eigen::Vector3d& factor);
/// The same body, so many times as large, of the same mass.
Body scaled(Body body, double factor);

}  // namespace prehend::grasping
