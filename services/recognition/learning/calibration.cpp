#include "calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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
  double second = 0;  // a class that is nowhere near scores about nothing
  for (Eigen::Index i = 0; i < scores.size(); ++i)
    if (i != best) second = std::max<double>(second, scores[i]);
  made.margin = made.score - second;
  made.similarity = similarity[best];
  return made;
}

double Calibration::probability(const Grounds& grounds) const {
  const double made = 1 / (1 + std::exp(-w.dot(row(grounds))));
  return std::isfinite(made) ? made : 0;
}

Calibration fit(const std::vector<Outcome>& outcomes) {
  Calibration made;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Vector4d gradient = -0.05 * made.w;
    Eigen::Matrix4d hessian = 0.05 * Eigen::Matrix4d::Identity();
    for (const Outcome& outcome : outcomes) {
      const Eigen::Vector4d x = row(outcome.grounds);
      const double p = made.probability(outcome.grounds);
      gradient += outcome.weight * ((outcome.right ? 1 : 0) - p) * x;
      hessian += outcome.weight * std::max(1e-6, p * (1 - p)) * x * x.transpose();
    }
    const Eigen::Vector4d step = hessian.ldlt().solve(gradient);
    made.w += step.norm() > 5 ? Eigen::Vector4d(5 * step.normalized()) : step;
    if (step.norm() < 1e-6) break;
  }
  return made;
}

}  // namespace prehend::recognition
