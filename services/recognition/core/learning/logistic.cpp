#include "services/recognition/core/learning/logistic.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace prehend::recognition {

Eigen::VectorXd logistic_fit(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& weight) {
  constexpr double ridge = 0.05;
  Eigen::VectorXd w = Eigen::VectorXd::Zero(rows.cols());
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::VectorXd gradient = -ridge * w;
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(rows.cols(), rows.cols());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const Eigen::VectorXd x = rows.row(i).transpose();
      const double p = 1 / (1 + std::exp(-w.dot(x)));
      gradient += weight[i] * (right[i] - p) * x;
      hessian += weight[i] * std::max(1e-6, p * (1 - p)) * x * x.transpose();
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(gradient);
    w += step.norm() > 5 ? Eigen::VectorXd(5 * step.normalized()) : step;
    if (step.norm() < 1e-6) break;
  }
  return w;
}

}  // namespace prehend::recognition
