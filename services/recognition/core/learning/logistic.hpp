#pragma once

#include <Eigen/Core>

namespace prehend::recognition {

/// Logistic regression by Newton's method with a small ridge: w for which 1 / (1 + exp(-w . row))
/// is the probability that a row is right. `right`: 1 or 0 of each row; `weight`: how much it
/// counts.
Eigen::VectorXd logistic_fit(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& weight);

}  // namespace prehend::recognition
