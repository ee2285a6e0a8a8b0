#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/resistance.hpp"
#include "common/base/error.hpp"
#include "common/model/shape.hpp"

namespace prehend::analysis {

/// How well a grasp resists disturbances, with the volume of the convex hull of its wrenches, which
/// only the whole hull tells.
struct Quality : Resistance {
  double volume = 0;  // 0 when the hull is flat
};

/// Ferrari & Canny's ε and the volume in the L1 sense by Qhull: hull of all columns (any dimension
/// of at least 2), the origin not added. Where the volume is not wanted, l1_resistance() gives the
/// same ε in a small part of the time. Fails on values that are not finite; too few or flat points
/// are no failure but have no force closure.
Expected<Quality> wrench_quality(const Eigen::MatrixXd& wrenches);

/// ρ: the largest distance of a point of the shape from its centre, m.
double torque_scale(const model::Shape& shape);

/// Quality of contacts on an object with that ρ (at most ten contacts count).
Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, double torque_scale);

/// The same on a shape whose centre of mass is its centre.
Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, const model::Shape& shape);

}  // namespace prehend::analysis
