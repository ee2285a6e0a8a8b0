#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/mesh.hpp"

namespace prehend::grasping {

struct PartsOptions {
  /// Share of the solid's volume by which all parts together may exceed it. A mesh whose own hull
  /// exceeds it by less is taken as that hull.
  double max_excess = 0.03;
  /// At most so many parts, however much they exceed it then.
  int max_parts = 16;
};

/// A solid as a union of convex ones that covers it, which is what Bullet can collide.
struct ConvexParts {
  std::vector<std::vector<Eigen::Vector3d>> parts;  // corners of each, m
  double concavity = 0;  // volume of the mesh's hull over that of the mesh, less 1: 0 when convex
  double excess = 0;     // the same of the parts
};

/// Cuts the box about the mesh by planes along the axes, always where that takes most off what the
/// hulls of the pieces exceed the solid by, until little is left (greedy; in the spirit of Mamou's
/// volumetric decomposition, but with exact pieces of the surface). Deterministic. Curved hollows
/// need more parts than max_parts: `excess` says what is left. Fails when no hull can be made.
Expected<ConvexParts> convex_parts(const model::Mesh& mesh, const PartsOptions& options = {});

}  // namespace prehend::grasping
