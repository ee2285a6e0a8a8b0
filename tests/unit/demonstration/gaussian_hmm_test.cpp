// Hidden Markov models against what their definition says: sums over all paths, written out.
#include "services/demonstration/core/recognition/gaussian_hmm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::demonstration {
namespace {

Eigen::VectorXd random_probabilities(Eigen::Index n, Random& random) {
  const Eigen::VectorXd p = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(0.1, 1); });
  return p / p.sum();
}

HmmParameters random_parameters(Eigen::Index states, Eigen::Index size, Random& random) {
  HmmParameters made{random_probabilities(states, random), Eigen::MatrixXd(states, states),
                     Eigen::MatrixXd(size, states), Eigen::MatrixXd(size, states)};
  for (Eigen::Index i = 0; i < states; ++i)
    made.transition.row(i) = random_probabilities(states, random);
  for (double& mean : made.means.reshaped()) mean = random.normal(2);
  for (double& variance : made.variances.reshaped()) variance = random.uniform(0.2, 2);
  return made;
}

Sequence random_sequence(Eigen::Index size, Eigen::Index length, Random& random) {
  return Sequence::NullaryExpr(size, length, [&] { return random.normal(2); });
}

double density(const HmmParameters& hmm, Eigen::Index state, const Eigen::VectorXd& x) {
  double p = 1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double off = x[i] - hmm.means(i, state), variance = hmm.variances(i, state);
    p *= std::exp(-off * off / (2 * variance)) / std::sqrt(2 * std::numbers::pi * variance);
  }
  return p;
}

/// P(observations, path) of every path, in order of number: state at t is digit t.
std::vector<double> all_paths(const HmmParameters& hmm, const Sequence& sequence) {
  const Eigen::Index n = hmm.initial.size();
  std::vector<double> made;
  const auto paths = static_cast<int>(std::pow(n, sequence.cols()));
  for (int path = 0; path < paths; ++path) {
    double p = 1;
    int rest = path;
    Eigen::Index before = -1;
    for (Eigen::Index t = 0; t < sequence.cols(); ++t) {
      const Eigen::Index state = rest % n;
      rest /= static_cast<int>(n);
      p *= before < 0 ? hmm.initial[state] : hmm.transition(before, state);
      p *= density(hmm, state, sequence.col(t));
      before = state;
    }
    made.push_back(p);
  }
  return made;
}

Sequence drawn(const HmmParameters& hmm, Eigen::Index length, Random& random) {
  Sequence made(hmm.means.rows(), length);
  const auto draw = [&](const auto& p) {
    double left = random.uniform();
    for (Eigen::Index i = 0; i < p.size(); ++i)
      if ((left -= p[i]) < 0) return i;
    return p.size() - 1;
  };
  Eigen::Index state = draw(hmm.initial);
  for (Eigen::Index t = 0; t < length; ++t) {
    for (Eigen::Index i = 0; i < made.rows(); ++i)
      made(i, t) = hmm.means(i, state) + random.normal(std::sqrt(hmm.variances(i, state)));
    state = draw(hmm.transition.row(state));
  }
  return made;
}

TEST(GaussianHmm, ForwardIsTheSumOverAllPaths) {
  Random random(1);
  for (int round = 0; round < 40; ++round) {
    const auto states = static_cast<Eigen::Index>(1 + random.index(3));
    const auto hmm = random_parameters(states, 2, random);
    const auto model = GaussianHmm::create(hmm);
    ASSERT_TRUE(model) << model.error().message();
    const Sequence sequence =
        random_sequence(2, static_cast<Eigen::Index>(1 + random.index(5)), random);
    double sum = 0;
    for (const double p : all_paths(hmm, sequence)) sum += p;
    // The same sum in another order: only rounding differs.
    EXPECT_NEAR(model->log_likelihood(sequence), std::log(sum), 1e-9);
  }
}

TEST(GaussianHmm, StreamedIsWhatTheWholeSequenceGives) {
  Random random(2);
  const auto model = GaussianHmm::create(random_parameters(3, 2, random));
  ASSERT_TRUE(model);
  const Sequence sequence = random_sequence(2, 300, random);  // P would be 0 as a number
  GaussianHmm::Forward forward(*model);
  for (Eigen::Index t = 0; t < sequence.cols(); ++t)
    EXPECT_DOUBLE_EQ(forward.add(sequence.col(t)), model->log_likelihood(sequence.leftCols(t + 1)));
  EXPECT_TRUE(std::isfinite(model->log_likelihood(sequence)));
}

TEST(GaussianHmm, BaumWelchNeverMakesSequencesLessLikely) {
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    std::vector<Sequence> sequences;
    for (int i = 0; i < 8; ++i)
      sequences.push_back(
          random_sequence(2, static_cast<Eigen::Index>(3 + random.index(10)), random));
    const auto start = round % 2 == 0 ? GaussianHmm::create(random_parameters(3, 2, random))
                                      : GaussianHmm::left_to_right(sequences, 3, 1e-6);
    ASSERT_TRUE(start);
    const HmmFit fit = baum_welch(*start, sequences, 25, 1e-6);
    ASSERT_GT(fit.log_likelihoods.size(), 2U);
    for (std::size_t i = 1; i < fit.log_likelihoods.size(); ++i)
      EXPECT_GE(fit.log_likelihoods[i], fit.log_likelihoods[i - 1] - 1e-8);
    double now = 0;
    for (const Sequence& sequence : sequences) now += fit.model.log_likelihood(sequence);
    EXPECT_NEAR(now, fit.log_likelihoods.back(), 1e-6) << "the last number is another model's";
  }
}

TEST(GaussianHmm, RecoversTheModelThatMadeTheSequences) {
  Random random(4);
  HmmParameters truth{Eigen::Vector2d(0.7, 0.3), Eigen::Matrix2d{{0.9, 0.1}, {0.2, 0.8}},
                      Eigen::MatrixXd{{0.0, 4.0}}, Eigen::MatrixXd{{1.0, 0.25}}};
  std::vector<Sequence> sequences;
  for (int i = 0; i < 400; ++i) sequences.push_back(drawn(truth, 30, random));
  HmmParameters guess = truth;
  guess.initial.setConstant(0.5);
  guess.transition.setConstant(0.5);
  guess.means << 1, 3;
  guess.variances.setConstant(2);
  const HmmFit fit = baum_welch(*GaussianHmm::create(guess), sequences, 100, 1e-6);
  const HmmParameters& found = fit.model.parameters();
  // 12000 observations, 400 beginnings: three standard errors.
  EXPECT_LT((found.means - truth.means).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_LT((found.variances - truth.variances).cwiseAbs().maxCoeff(), 0.08);
  EXPECT_LT((found.transition - truth.transition).cwiseAbs().maxCoeff(), 0.03);
  EXPECT_LT((found.initial - truth.initial).cwiseAbs().maxCoeff(), 0.08);
}

TEST(GaussianHmm, LeftToRightNeverGoesBackAndTakesShortSequences) {
  Random random(5);
  const std::vector<Sequence> sequences{
      random_sequence(2, 1, random), random_sequence(2, 0, random), random_sequence(2, 12, random)};
  const auto start = GaussianHmm::left_to_right(sequences, 5, 0.1);
  ASSERT_TRUE(start) << start.error().message();
  const HmmFit fit = baum_welch(*start, sequences, 10, 0.1);
  EXPECT_GE(fit.model.parameters().variances.minCoeff(), 0.1);
  for (int from = 0; from < 5; ++from)
    for (int to = 0; to < 5; ++to)
      if (to < from || to > from + 1) {
        EXPECT_EQ(fit.model.parameters().transition(from, to), 0);
      }
  EXPECT_TRUE(std::isfinite(fit.model.log_likelihood(sequences[0])));
}

TEST(GaussianHmm, RefusesWhatIsNoModel) {
  Random random(6);
  const auto good = random_parameters(3, 2, random);
  ASSERT_TRUE(GaussianHmm::create(good));
  for (int broken = 0; broken < 7; ++broken) {
    HmmParameters bad = good;
    if (broken == 0) bad.initial *= 2;
    if (broken == 1) bad.transition(1, 1) = -0.1;
    if (broken == 2) bad.variances(0, 0) = 0;
    if (broken == 3) bad.means(1, 2) = std::nan("");
    if (broken == 4) bad.means.conservativeResize(3, 3);
    if (broken == 5) bad.initial.resize(0);
    if (broken == 6) bad.transition.conservativeResize(2, 3);
    EXPECT_FALSE(GaussianHmm::create(bad)) << broken;
  }
  EXPECT_FALSE(GaussianHmm::left_to_right({}, 3, 0.1));
  EXPECT_FALSE(GaussianHmm::left_to_right({Sequence::Constant(2, 3, std::nan(""))}, 3, 0.1));
  EXPECT_EQ(
      GaussianHmm::left_to_right({Sequence::Zero(2, 3), Sequence::Zero(3, 3)}, 3, 0.1).error().what,
      "observations are of different sizes");
}

}  // namespace
}  // namespace prehend::demonstration
