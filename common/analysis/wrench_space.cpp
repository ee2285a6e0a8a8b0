#include "common/analysis/wrench_space.hpp"

#include <algorithm>
#include <cmath>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/convex_hull.hpp"

namespace prehend::analysis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

Expected<Quality> wrench_quality(const MatrixXd& wrenches) {
  if (!wrenches.allFinite()) return fail("wrenches must be finite");
  if (wrenches.rows() < 2) return fail("wrenches need at least two dimensions");
  if (!spans_all_dimensions(wrenches))
    return Quality{resistance_at(0, VectorXd::Zero(wrenches.rows())), 0};
  const auto hull = convex_hull(wrenches);
  if (!hull) return tl::unexpected(hull.error());
  Eigen::Index nearest = 0;
  const double distance = hull->offsets.minCoeff(&nearest);
  return Quality{resistance_at(distance, hull->normals.col(nearest)), hull->volume};
}

double torque_scale(const model::Shape& shape) {
  if (shape.kind == model::ShapeKind::cylinder)
    return std::hypot(shape.size.x(), 0.5 * shape.size.z());
  if (shape.kind == model::ShapeKind::sphere) return shape.size.x();
  if (shape.kind == model::ShapeKind::cone) {
    const double half = 0.5 * shape.size.z(), middle = model::centre_of_mass(shape).z();
    return std::max(std::hypot(shape.size.x(), half + middle),
                    std::hypot(shape.size.y(), half - middle));
  }
  return model::half_extents(shape).norm();
}

Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, double torque_scale) {
  if (!(torque_scale > 0)) return fail("the scale of torques must be positive");
  return wrench_quality(contact_wrenches(spread_contacts(contacts, max_contacts), torque_scale));
}

Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, const model::Shape& shape) {
  if (!model::is_valid(shape)) return fail("the object has no valid shape");
  return grasp_quality(contacts, torque_scale(shape));
}

}  // namespace prehend::analysis
