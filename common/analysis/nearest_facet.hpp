#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "common/base/error.hpp"

namespace prehend::analysis {

/// A convex polytope known by its support mapping: the vertex farthest along a direction.
using Support = std::function<Eigen::VectorXd(const Eigen::VectorXd& direction)>;

/// The plane that bounds a polytope nearest to the origin: normal · x = distance, unit normal
/// outward. Unless the origin lies inside, distance is 0 or less and only some plane that shows it.
struct NearestFacet {
  double distance = 0;
  Eigen::VectorXd normal;
};

/// The nearest facet without the whole hull: a hull of few vertices grows only where it is nearest
/// to the origin, towards the farthest vertex beyond that facet, until no vertex lies beyond it.
/// It is then a facet of the whole polytope too, and all others, inner or not yet found, are
/// farther (Liu & Carpin, Fast grasp quality evaluation with partial convex hull computation, ICRA
/// 2015; Zheng, An efficient algorithm for a grasp quality measure, T-RO 29(2), 2013).
/// Dimension 2 to 6. Exact to 5e-11 of the polytope's largest coordinate: vertices are moved by at
/// most 1e-11 of it, always alike, so that no more than `dimension` of them lie in one plane.
/// Nothing for a flat polytope (thinner than 1e-9 of it). Fails when the hull outgrows 2 million
/// facets.
Expected<std::optional<NearestFacet>> nearest_facet(int dimension, const Support& support);

}  // namespace prehend::analysis
