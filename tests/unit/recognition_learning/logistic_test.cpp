// Outcomes drawn with known weights give the weights back: with n rows the fit's standard deviation
// is that of the inverse information, about 0.1 for 4000 rows of unit variance; 0.4 is four of
// them.
#include "services/recognition/core/learning/logistic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"

namespace prehend::recognition {
namespace {

TEST(Logistic, GivesBackTheWeightsThatOutcomesWereDrawnWith) {
  constexpr Eigen::Index n = 4000;
  const Eigen::Vector3d truth(-0.5, 2, -1);
  Random random(1);
  Eigen::MatrixXd rows(n, 3);
  Eigen::VectorXd right(n), weight = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.row(i) << 1, random.normal(), random.normal();
    right[i] = random.uniform() < 1 / (1 + std::exp(-rows.row(i).dot(truth)));
  }
  EXPECT_LT((logistic_fit(rows, right, weight) - truth).cwiseAbs().maxCoeff(), 0.4);
  // A row that counts nothing might as well be missing.
  weight.tail(n / 2).setZero();
  const Eigen::VectorXd half = logistic_fit(rows, right, weight);
  right.tail(n / 2).setOnes();
  EXPECT_EQ(logistic_fit(rows, right, weight), half);
}

// Without the ridge the weights of outcomes that a plane parts would grow without end.
TEST(Logistic, OutcomesThatPartExactlyGiveFiniteWeights) {
  Eigen::MatrixXd rows(20, 2);
  Eigen::VectorXd right(20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    rows.row(i) << 1, static_cast<double>(i) - 9.5;
    right[i] = i >= 10;
  }
  const Eigen::VectorXd w = logistic_fit(rows, right, Eigen::VectorXd::Ones(20));
  EXPECT_TRUE(w.allFinite());
  EXPECT_GT(w[1], 1);
  EXPECT_LT(w.norm(), 100);
}

}  // namespace
}  // namespace prehend::recognition
