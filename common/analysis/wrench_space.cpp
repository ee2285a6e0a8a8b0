#include "wrench_space.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <limits>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace prehend::analysis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;


/// Frees what Qhull has allocated, whatever happened.
struct Hull {
  qhT qh;
  Hull() { qh_zero(&qh, nullptr); }
  ~Hull() {
    qh_freeqhull(&qh, !qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&qh, &current, &total);
  }
  Hull(const Hull&) = delete;
  Hull& operator=(const Hull&) = delete;
};

bool spans_all_dimensions(const MatrixXd& points) {
  const MatrixXd centred = points.colwise() - points.rowwise().mean();
  const Eigen::JacobiSVD<MatrixXd> svd(centred);
  const VectorXd& s = svd.singularValues();
  return s.size() == points.rows() && s[s.size() - 1] > 1e-9 * s[0];
}

}  // namespace

Expected<Quality> wrench_quality(const MatrixXd& wrenches) {
  if (!wrenches.allFinite()) return fail("wrenches must be finite");
  const Eigen::Index dimension = wrenches.rows();
  if (dimension < 2) return fail("wrenches need at least two dimensions");
  Quality quality{resistance_at(0, VectorXd::Zero(dimension)), 0};
  if (wrenches.cols() <= dimension || !spans_all_dimensions(wrenches)) return quality;

  // QJ joggles coplanar points, which grasps of symmetric objects always have; Qt and Qx fail
  // there.
  MatrixXd points = wrenches;  // column-major: one point after the other, as Qhull wants them
  char options[] = "qhull QJ Pp";
  Hull hull;
  if (qh_new_qhull(&hull.qh, static_cast<int>(dimension), static_cast<int>(points.cols()),
                   points.data(), False, options, nullptr, nullptr) != 0)
    return fail("convex hull failed", {}, "the wrenches are nearly degenerate");
  qh_getarea(&hull.qh, hull.qh.facet_list);
  quality.volume = hull.qh.totvol;

  double nearest = std::numeric_limits<double>::infinity();
  const facetT* weakest = nullptr;
  for (const facetT* facet = hull.qh.facet_list; facet && facet->next; facet = facet->next)
    if (-facet->offset < nearest) {
      nearest = -facet->offset;
      weakest = facet;
    }
  if (weakest)
    static_cast<Resistance&>(quality) =
        resistance_at(nearest, Eigen::Map<const VectorXd>(weakest->normal, dimension));
  return quality;
}

double torque_scale(const model::Shape& shape) {
  if (shape.kind == model::ShapeKind::cylinder)
    return std::hypot(shape.size.x(), 0.5 * shape.size.z());
  if (shape.kind == model::ShapeKind::sphere) return shape.size.x();
  return model::half_extents(shape).norm();
}

Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, const model::Shape& shape) {
  if (!model::is_valid(shape)) return fail("the object has no valid shape");
  return wrench_quality(
      contact_wrenches(spread_contacts(contacts, most_contacts), torque_scale(shape)));
}

}  // namespace prehend::analysis
