#include "services/recognition/core/learning/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "services/recognition/core/learning/logistic.hpp"

namespace prehend::recognition {
namespace {

Eigen::Vector4d row(const Grounds& e) {
  return {1, e.score, e.margin, e.similarity};
}

}  // namespace

Grounds grounds(const Eigen::VectorXf& scores, const Eigen::VectorXf& similarity) {
  Grounds made;
  if (scores.size() == 0) return made;
  Eigen::Index best;
  made.score = scores.maxCoeff(&best);
  made.best = static_cast<int>(best);
  Eigen::VectorXf others = scores;
  others[best] = 0;  // a class that is nowhere near scores about nothing
  made.margin = made.score - std::max<double>(0, others.maxCoeff());
  made.similarity = similarity[best];
  return made;
}

double Calibration::probability(const Grounds& grounds) const {
  const double made = 1 / (1 + std::exp(-w.dot(row(grounds))));
  return std::isfinite(made) ? made : 0;
}

Calibration fit(const std::vector<Outcome>& outcomes) {
  const auto n = static_cast<Eigen::Index>(outcomes.size());
  Eigen::MatrixXd rows(n, 4);
  Eigen::VectorXd right(n), weight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Outcome& outcome = outcomes[static_cast<std::size_t>(i)];
    rows.row(i) = row(outcome.grounds);
    right[i] = outcome.right ? 1 : 0;
    weight[i] = outcome.weight;
  }
  return {logistic_fit(rows, right, weight)};
}

}  // namespace prehend::recognition
