#include "services/demonstration/core/recognition/gaussian_hmm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace prehend::demonstration {

namespace {

constexpr double impossible = -std::numeric_limits<double>::infinity();
constexpr double same_sum = 1e-6;
constexpr double converged = 1e-7;  // of the likelihood, relative

double log_sum(const auto& logs) {
  const double most = logs.maxCoeff();
  if (most == impossible) return impossible;
  return most + std::log((logs.array() - most).exp().sum());
}

bool are_probabilities(const auto& p) {
  return p.allFinite() && p.minCoeff() >= 0 && std::abs(p.sum() - 1) < same_sum;
}

/// What all sequences together say of a model's numbers.
struct Counts {
  Counts(Eigen::Index size, Eigen::Index states)
      : initial(Eigen::VectorXd::Zero(states)),
        visits(Eigen::VectorXd::Zero(states)),
        steps(Eigen::MatrixXd::Zero(states, states)),
        sums(Eigen::MatrixXd::Zero(size, states)),
        squares(Eigen::MatrixXd::Zero(size, states)) {}
  Eigen::VectorXd initial, visits;
  Eigen::MatrixXd steps, sums, squares;
};

/// What was impossible stays so: Eigen's exp of -inf over several numbers at once is not quite 0.
template <class Old, class Count>
auto still_possible(const Old& old, const Count& count) {
  return (old.array() > 0).select(count, 0.0).eval();
}

HmmParameters from_counts(const Counts& counts, HmmParameters made, double min_variance) {
  made.initial = still_possible(made.initial, counts.initial) / counts.initial.sum();
  for (Eigen::Index s = 0; s < made.initial.size(); ++s) {
    const double left = counts.steps.row(s).sum();
    if (left > 0)
      made.transition.row(s) = still_possible(made.transition.row(s), counts.steps.row(s)) / left;
    if (counts.visits[s] <= 0) continue;  // nobody came here: it stays as it is
    made.means.col(s) = counts.sums.col(s) / counts.visits[s];
    made.variances.col(s) =
        (counts.squares.col(s) / counts.visits[s] - made.means.col(s).cwiseAbs2())
            .cwiseMax(min_variance);
  }
  return made;
}

}  // namespace

GaussianHmm::GaussianHmm(HmmParameters parameters)
    : parameters_(std::move(parameters)),
      log_initial_(parameters_.initial.array().log()),
      log_transition_(parameters_.transition.array().log()),
      half_precisions_(0.5 * parameters_.variances.cwiseInverse()),
      log_scales_(-0.5 *
                  (2 * std::numbers::pi * parameters_.variances.array()).log().colwise().sum()) {}

Expected<GaussianHmm> GaussianHmm::create(HmmParameters parameters) {
  const auto n = parameters.initial.size();
  if (n == 0 || parameters.transition.rows() != n || parameters.transition.cols() != n ||
      parameters.means.cols() != n || parameters.variances.cols() != n ||
      parameters.means.rows() == 0 || parameters.means.rows() != parameters.variances.rows())
    return fail("sizes of a hidden Markov model do not fit each other");
  bool sound = are_probabilities(parameters.initial);
  for (Eigen::Index i = 0; i < n; ++i) sound &= are_probabilities(parameters.transition.row(i));
  if (!sound) return fail("probabilities of a hidden Markov model do not sum to 1");
  if (!parameters.means.allFinite() || !parameters.variances.allFinite() ||
      parameters.variances.minCoeff() <= 0)
    return fail("a state's mean or variance is no sound number");
  return GaussianHmm(std::move(parameters));
}

Expected<GaussianHmm> GaussianHmm::left_to_right(const std::vector<Sequence>& sequences, int states,
                                                 double min_variance) {
  Eigen::Index size = 0, length = 0;
  for (const Sequence& sequence : sequences) {
    if (!sequence.allFinite()) return fail("an observation is no sound number");
    if (size > 0 && sequence.cols() > 0 && sequence.rows() != size)
      return fail("observations are of different sizes");
    if (sequence.cols() > 0) size = sequence.rows();
    length += sequence.cols();
  }
  if (states < 1 || length == 0) return fail("no observations to learn a hidden Markov model from");
  Counts counts(size, states);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size), squares = all;
  for (const Sequence& sequence : sequences)
    for (Eigen::Index t = 0; t < sequence.cols(); ++t) {
      const auto state = t * states / sequence.cols();
      counts.visits[state] += 1;
      counts.sums.col(state) += sequence.col(t);
      counts.squares.col(state) += sequence.col(t).cwiseAbs2();
      all += sequence.col(t);
      squares += sequence.col(t).cwiseAbs2();
    }
  all /= static_cast<double>(length);
  squares = (squares / static_cast<double>(length) - all.cwiseAbs2()).cwiseMax(min_variance);
  counts.initial[0] = 1;
  const double moves =
      std::min(0.9, static_cast<double>(states * sequences.size()) / static_cast<double>(length));
  for (int s = 0; s + 1 < states; ++s) {
    counts.steps(s, s) = 1 - moves;
    counts.steps(s, s + 1) = moves;
  }
  counts.steps(states - 1, states - 1) = 1;
  return create(from_counts(
      counts,
      {counts.initial, counts.steps, all.replicate(1, states), squares.replicate(1, states)},
      std::max(min_variance, 1e-9)));
}

Eigen::MatrixXd GaussianHmm::log_emissions(const Sequence& sequence) const {
  Eigen::MatrixXd logs(states(), sequence.cols());
  for (Eigen::Index t = 0; t < sequence.cols(); ++t)
    for (Eigen::Index s = 0; s < logs.rows(); ++s)
      logs(s, t) = log_scales_[s] - ((parameters_.means.col(s) - sequence.col(t)).array().square() *
                                     half_precisions_.col(s).array())
                                        .sum();
  return logs;
}

double GaussianHmm::Forward::add(const Eigen::VectorXd& x) {
  const Eigen::VectorXd emissions = model_->log_emissions(x);
  if (log_alpha_.size() == 0) {
    log_alpha_ = model_->log_initial_ + emissions;
  } else {
    Eigen::VectorXd next(log_alpha_.size());
    for (Eigen::Index to = 0; to < next.size(); ++to)
      next[to] = log_sum((log_alpha_ + model_->log_transition_.col(to)).eval()) + emissions[to];
    log_alpha_ = std::move(next);
  }
  return log_sum(log_alpha_);
}

double GaussianHmm::log_likelihood(const Sequence& sequence) const {
  Forward forward(*this);
  double log = 0;
  for (Eigen::Index t = 0; t < sequence.cols(); ++t) log = forward.add(sequence.col(t));
  return log;
}

namespace {

/// Forward and backward probabilities of one sequence; adds what they say to `counts` and returns
/// its log likelihood. A sequence that the model cannot make says nothing.
double gather(const GaussianHmm& model, const Sequence& sequence, Counts& counts) {
  const Eigen::Index n = model.states(), length = sequence.cols();
  const Eigen::MatrixXd emissions = model.log_emissions(sequence);
  Eigen::MatrixXd alpha(n, length), beta = Eigen::MatrixXd::Zero(n, length);
  alpha.col(0) = model.log_initial() + emissions.col(0);
  for (Eigen::Index t = 1; t < length; ++t)
    for (Eigen::Index to = 0; to < n; ++to)
      alpha(to, t) =
          log_sum((alpha.col(t - 1) + model.log_transition().col(to)).eval()) + emissions(to, t);
  const double log = log_sum(alpha.col(length - 1));
  if (log == impossible) return 0;
  for (Eigen::Index t = length - 1; t-- > 0;)
    for (Eigen::Index from = 0; from < n; ++from)
      beta(from, t) = log_sum(
          (model.log_transition().row(from).transpose() + emissions.col(t + 1) + beta.col(t + 1))
              .eval());
  const Eigen::MatrixXd gamma = ((alpha + beta).array() - log).exp();
  counts.initial += gamma.col(0);
  counts.visits += gamma.rowwise().sum();
  counts.sums += sequence * gamma.transpose();
  counts.squares += sequence.cwiseAbs2() * gamma.transpose();
  for (Eigen::Index t = 0; t + 1 < length; ++t)
    for (Eigen::Index to = 0; to < n; ++to)
      counts.steps.col(to).array() +=
          (alpha.col(t).array() + model.log_transition().col(to).array() +
           (emissions(to, t + 1) + beta(to, t + 1) - log))
              .exp();
  return log;
}

}  // namespace

HmmFit baum_welch(const GaussianHmm& start, const std::vector<Sequence>& sequences, int iterations,
                  double min_variance) {
  HmmFit fit{start, {}};
  for (int i = 0;; ++i) {
    Counts counts(start.size(), start.states());
    double total = 0;
    for (const Sequence& sequence : sequences)
      if (sequence.cols() > 0) total += gather(fit.model, sequence, counts);
    const bool stands =
        !fit.log_likelihoods.empty() &&
        total - fit.log_likelihoods.back() < converged * std::abs(fit.log_likelihoods.back());
    fit.log_likelihoods.push_back(total);
    if (i == iterations || stands || counts.initial.sum() <= 0) return fit;
    auto next = GaussianHmm::create(from_counts(counts, fit.model.parameters(), min_variance));
    if (!next) return fit;  // a state has shrunk to a point: the model before it stands
    fit.model = std::move(*next);
  }
}

}  // namespace prehend::demonstration
