#include "wrench_space.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace prehend::analysis {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Below this distance a hull that touches the origin and one that contains it look the same: Qhull
// moves points by about 1e-11 to resolve coplanar ones.
constexpr double least_epsilon = 1e-9;
constexpr std::size_t most_contacts = 10;

Vector3d any_perpendicular(const Vector3d& n) {
  Eigen::Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vector3d::Unit(smallest)).normalized();
}

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

MatrixXd contact_wrenches(const std::vector<Contact>& contacts, double torque_scale, int edges,
                          const std::vector<Vector3d>& tangents) {
  MatrixXd wrenches(6, static_cast<Eigen::Index>(contacts.size()) * edges);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vector3d n = contacts[i].normal_O.normalized();
    Vector3d t1 = any_perpendicular(n);
    if (i < tangents.size()) {
      const Vector3d given = tangents[i] - tangents[i].dot(n) * n;
      if (given.norm() > 1e-9) t1 = given.normalized();
    }
    const Vector3d t2 = n.cross(t1);
    for (int k = 0; k < edges; ++k) {
      const double angle = 2 * std::numbers::pi * k / edges;
      const Vector3d f = n + contacts[i].friction * (std::cos(angle) * t1 + std::sin(angle) * t2);
      wrenches.col(column++) << f, contacts[i].p_OC.cross(f) / torque_scale;
    }
  }
  return wrenches;
}

Expected<Quality> wrench_quality(const MatrixXd& wrenches) {
  if (!wrenches.allFinite()) return fail("wrenches must be finite");
  const Eigen::Index dimension = wrenches.rows();
  if (dimension < 2) return fail("wrenches need at least two dimensions");
  Quality quality;
  quality.weakest_direction = VectorXd::Zero(dimension);
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
  if (!weakest || nearest < least_epsilon) return quality;
  quality.epsilon = nearest;
  quality.force_closure = true;
  // The grasp can push least along the facet's outward normal, so a load the other way is hardest.
  quality.weakest_direction = -Eigen::Map<const VectorXd>(weakest->normal, dimension);
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
