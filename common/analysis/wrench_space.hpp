#pragma once

#include <Eigen/Core>
#include <prehend/base/error.hpp>
#include <prehend/model/shape.hpp>
#include <vector>

#include "contact.hpp"

namespace prehend::analysis {

/// How well a grasp resists disturbances: measures of the convex hull of its wrenches.
struct Quality {
  double epsilon = -1;  // distance from the origin to the hull's surface; -1: no force closure
  double volume = 0;    // of the hull; 0 when it is flat
  bool force_closure = false;
  Eigen::VectorXd weakest_direction;  // unit wrench hardest to resist; zero without force closure
};

/// Wrenches as columns (f, τ/ρ) of all friction edges of all contacts, about the centre of mass:
/// edge k is n + μ (cos θ t₁ + sin θ t₂), θ = 2πk/edges, t₂ = n × t₁, not normalised, and τ = r ×
/// f. tangents: t₁ of each contact, or empty to have them chosen; they are made perpendicular to n.
Eigen::MatrixXd contact_wrenches(const std::vector<Contact>& contacts, double torque_scale,
                                 int edges = 8, const std::vector<Eigen::Vector3d>& tangents = {});

/// Ferrari & Canny's ε and volume in the L1 sense: hull of all columns (any dimension of at least
/// 2), the origin not added. Fails on values that are not finite; too few or flat points are no
/// failure but have no force closure.
Expected<Quality> wrench_quality(const Eigen::MatrixXd& wrenches);

/// ρ: the largest distance of a point of the shape from its centre, m.
double torque_scale(const model::Shape& shape);

/// Quality of contacts on a shape whose centre of mass is its centre (at most ten contacts count).
Expected<Quality> grasp_quality(const std::vector<Contact>& contacts, const model::Shape& shape);

}  // namespace prehend::analysis
