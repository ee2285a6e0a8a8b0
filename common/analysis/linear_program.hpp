#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/error.hpp"

namespace prehend::analysis {

/// Minimise cost · x subject to row_lower <= rows x <= row_upper and lower <= x <= upper, where
/// infinite bounds are no bounds. Constraints hold to 1e-9, absolutely: numbers should be near one.
struct LinearProgram {
  Eigen::VectorXd cost;
  Eigen::MatrixXd rows;
  Eigen::VectorXd row_lower, row_upper;
  Eigen::VectorXd lower, upper;

  /// `variables` without bounds below zero and `constraints` rows, all zero.
  LinearProgram(Eigen::Index variables, Eigen::Index constraints);
};

/// A best x, or nothing when no x satisfies the constraints. Fails on numbers that are not finite
/// (bounds may be infinite), when the cost has no lower bound, and when the solver gives up.
Expected<std::optional<Eigen::VectorXd>> minimise(const LinearProgram& program);

}  // namespace prehend::analysis
