#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::analysis {

/// The largest disturbance that a grasp resists whatever its direction: the radius of the largest
/// ball about the origin in the set of wrenches that the contacts can apply (Ferrari & Canny,
/// Planning optimal grasps, ICRA 1992).
struct Resistance {
  double epsilon = -1;  // distance from the origin to the set's surface; -1: no force closure
  bool force_closure = false;
  Eigen::VectorXd weakest_direction;  // unit wrench hardest to resist; zero without force closure
};

/// From here on an ε counts as force closure: a set that touches the origin and one that contains
/// it look the same below, since coplanar points are moved by about 1e-11 to resolve them.
inline constexpr double min_epsilon = 1e-9;

/// What a plane of the set's surface says: distance from the origin, unit normal outward.
Resistance resistance_at(double distance, const Eigen::VectorXd& normal);

/// ε in the L1 sense, normal forces adding up to at most one: convex hull of all columns, in 2 to 6
/// dimensions. Equal to the full hull's to 1e-9 without building it (see nearest_facet.hpp).
/// Fails on values that are not finite; too few or flat points have no force closure.
Expected<Resistance> l1_resistance(const Eigen::MatrixXd& wrenches);

/// ε in the L∞ sense, each contact's normal force at most one by itself: Minkowski sum over the
/// contacts of the hull of the origin and its wrenches. Only its support is asked,
/// h(u) = Σᵢ max(0, maxₖ u · wᵢₖ); the sum itself is never built. One matrix a contact.
Expected<Resistance> linf_resistance(const std::vector<Eigen::MatrixXd>& contact_wrenches);

}  // namespace prehend::analysis
