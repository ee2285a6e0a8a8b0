#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/analysis/contact.hpp"

namespace prehend::analysis {

/// What a contact can do to the object at unit normal force, as columns (force_O, moment about the
/// normal), 4 x k. With friction μ and tangents t₁, t₂ = n × t₁, edge k of a point contact is
/// n + μ (cos θ t₁ + sin θ t₂), θ = 2πk/edges, not normalised. A soft finger has three such rings,
/// at latitudes φ = 45°, 0, -45° of its ellipsoid (μ cos φ, torsion sin φ), and both poles. Without
/// friction and torsion there is the normal alone.
Eigen::Matrix4Xd friction_edges(const Contact& contact, int edges = 8);

/// The wrench (f, τ/ρ) about O of a contact's (force, moment about the normal): 6 x 4, τ = r × f.
Eigen::Matrix<double, 6, 4> contact_map(const Contact& contact, double torque_scale);

/// Wrenches as columns (f, τ/ρ) of the friction edges of one contact.
Eigen::MatrixXd edge_wrenches(const Contact& contact, double torque_scale, int edges = 8);

/// The same of all contacts, in their order.
Eigen::MatrixXd contact_wrenches(const std::vector<Contact>& contacts, double torque_scale,
                                 int edges = 8);

}  // namespace prehend::analysis
