#include "common/analysis/convex_hull.hpp"

#include <Eigen/SVD>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace prehend::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Frees what Qhull has allocated, whatever happened.
struct Qhull {
  qhT qh;
  Qhull() { qh_zero(&qh, nullptr); }
  ~Qhull() {
    qh_freeqhull(&qh, !qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&qh, &current, &total);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
};

}  // namespace

bool spans_all_dimensions(const MatrixXd& points) {
  if (points.cols() <= points.rows()) return false;
  const MatrixXd centred = points.colwise() - points.rowwise().mean();
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(centred).singularValues();
  return s.size() == points.rows() && s[s.size() - 1] > 1e-9 * s[0];
}

Expected<ConvexHull> convex_hull(const MatrixXd& points) {
  // QJ joggles coplanar points, which grasps of symmetric objects always have; Qt and Qx fail
  // there.
  const Index dimension = points.rows();
  MatrixXd own = points;  // column-major: one point after the other, as Qhull wants them
  char options[] = "qhull QJ Pp";
  Qhull hull;
  if (qh_new_qhull(&hull.qh, static_cast<int>(dimension), static_cast<int>(own.cols()), own.data(),
                   False, options, nullptr, nullptr) != 0)
    return fail("convex hull failed", {}, "the points are nearly degenerate");
  qh_getarea(&hull.qh, hull.qh.facet_list);
  ConvexHull made;
  made.volume = hull.qh.totvol;
  made.normals.resize(dimension, hull.qh.num_facets);
  made.offsets.resize(hull.qh.num_facets);
  made.vertices.resize(dimension, hull.qh.num_facets);
  Index column = 0;
  for (const facetT* facet = hull.qh.facet_list; facet && facet->next; facet = facet->next) {
    made.normals.col(column) = Eigen::Map<const VectorXd>(facet->normal, dimension);
    made.offsets[column] = -facet->offset;
    for (Index i = 0; i < dimension; ++i)
      made.vertices(i, column) =
          qh_pointid(&hull.qh, static_cast<const vertexT*>(facet->vertices->e[i].p)->point);
    ++column;
  }
  return made;
}

}  // namespace prehend::analysis
