#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::demonstration {

/// What a semi-Markov model knows before it looks: which state may follow which, and how long each
/// may last.
struct SemiMarkovOptions {
  Eigen::MatrixXd log_transition;  // row: from, column: to; −∞: never; no state follows itself
  Eigen::VectorXd log_initial;     // of the first state
  Eigen::VectorXi min_length, max_length;  // samples, of each state; what is cut at either end may
                                           // be shorter than its least
};

/// Samples begin .. end − 1 in one state.
struct Stretch {
  int state = 0;
  Eigen::Index begin = 0, end = 0;
  bool operator==(const Stretch&) const = default;
};

struct SemiMarkovPath {
  std::vector<Stretch> stretches;  // without gaps, from the first sample to the last
  double log_likelihood = 0;
};

/// The likeliest way through the states. scores: log p(sample | state), a row a state, a column a
/// sample. Exact; takes samples · states² · the longest length. Fails where sizes do not fit and
/// where nothing permitted explains the samples.
Expected<SemiMarkovPath> decode(const Eigen::MatrixXd& scores, const SemiMarkovOptions& options);

}  // namespace prehend::demonstration
