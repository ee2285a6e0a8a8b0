#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/error.hpp"

namespace prehend::demonstration {

/// Probabilities of classes; they sum to 1.
using Distribution = Eigen::VectorXd;

/// exp(score / temperature), renormalised. A high temperature makes a modest answer.
Distribution distribution_of(const Eigen::VectorXd& scores, double temperature);

/// What is known besides (of the object, of the task) multiplied in: p · prior, renormalised. A
/// prior is a number from 0 up for each class. Fails when it is not, and when it forbids all that
/// is possible.
Expected<Distribution> with_prior(const Distribution& p, const Eigen::VectorXd& prior);

struct Decision {
  std::optional<Eigen::Index> best;  // none: unknown
  double probability = 0;            // of the likeliest class
};
/// The likeliest class, or unknown if it is less likely than `min_probability`.
Decision decide(const Distribution& p, double min_probability);

/// The temperature, 0.05 to 20, with which these scores (a column an answer) say the truth best: by
/// least mean −log p(truth). truths: rows. 1 without answers.
double calibrated_temperature(const Eigen::MatrixXd& scores, const Eigen::VectorXi& truths);

}  // namespace prehend::demonstration
