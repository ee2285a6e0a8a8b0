#pragma once

#include <Eigen/Core>

#include "common/base/error.hpp"

namespace prehend::analysis {

/// The whole hull of points, of simplices; `facets` columns each.
struct ConvexHull {
  double volume = 0;
  Eigen::MatrixXd normals;   // unit, outward
  Eigen::VectorXd offsets;   // normal · x of each plane
  Eigen::MatrixXi vertices;  // `dimension` columns of the points
};

/// Whether points (columns) do not lie in one plane, to 1e-9 of their extent.
bool spans_all_dimensions(const Eigen::MatrixXd& points);

/// By Qhull, which displaces points by about 1e-11 of their size where they are coplanar, and by
/// more if that is not enough. Points must be finite and span all dimensions, at least two.
Expected<ConvexHull> convex_hull(const Eigen::MatrixXd& points);

}  // namespace prehend::analysis
