#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::demonstration {

/// A sequence of observations, a column a time.
using Sequence = Eigen::MatrixXd;

/// Numbers of a hidden Markov model. Probabilities sum to 1.
struct HmmParameters {
  Eigen::VectorXd initial;           // P(state at the first time)
  Eigen::MatrixXd transition;        // row: from, column: to
  Eigen::MatrixXd means, variances;  // of the observations, a column a state
};

/// A hidden Markov model whose states emit independent normal numbers. A value; all sums are kept
/// as logarithms, so that long sequences do not run out of range.
class GaussianHmm {
 public:
  /// Refuses sizes that do not fit, probabilities that do not sum to 1, variances that are not
  /// above 0.
  static Expected<GaussianHmm> create(HmmParameters parameters);
  /// States in a row, from each to itself or the next; every sequence is cut into equal parts, one
  /// a state. Sequences shorter than `states` fill what they reach.
  static Expected<GaussianHmm> left_to_right(const std::vector<Sequence>& sequences, int states,
                                             double min_variance);

  int states() const { return static_cast<int>(parameters_.initial.size()); }
  Eigen::Index size() const { return parameters_.means.rows(); }
  const HmmParameters& parameters() const { return parameters_; }
  const Eigen::VectorXd& log_initial() const { return log_initial_; }
  const Eigen::MatrixXd& log_transition() const { return log_transition_; }

  /// log P(observations), over all paths.
  double log_likelihood(const Sequence& sequence) const;

  /// log p(x | state), a row a state, a column an observation.
  Eigen::MatrixXd log_emissions(const Sequence& sequence) const;

  /// The likelihood while observations come in.
  class Forward {
   public:
    /// Keeps a reference to the model.
    explicit Forward(const GaussianHmm& model) : model_(&model) {}
    /// log P(all observations so far).
    double add(const Eigen::VectorXd& x);

   private:
    const GaussianHmm* model_;
    Eigen::VectorXd log_alpha_;
  };

 private:
  explicit GaussianHmm(HmmParameters parameters);

  HmmParameters parameters_;
  Eigen::VectorXd log_initial_;
  Eigen::MatrixXd log_transition_;
  Eigen::MatrixXd half_precisions_;
  Eigen::VectorXd log_scales_;
};

/// A model that was fitted, and the log likelihood of all sequences before each iteration and after
/// the last.
struct HmmFit {
  GaussianHmm model;
  std::vector<double> log_likelihoods;
};

/// Expectation maximisation [Rabiner1989], so many iterations at most. A variance below
/// `min_variance` is put there, which is the one thing that may make the likelihood fall.
HmmFit baum_welch(const GaussianHmm& start, const std::vector<Sequence>& sequences, int iterations,
                  double min_variance);

}  // namespace prehend::demonstration
