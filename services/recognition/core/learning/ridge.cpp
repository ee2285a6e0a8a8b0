#include "services/recognition/core/learning/ridge.hpp"

#include <Eigen/Cholesky>

namespace prehend::recognition {

Eigen::MatrixXf kernel_of(const Eigen::MatrixXf& similarities, double sharpness) {
  return ((similarities.array() - 1) * static_cast<float>(sharpness)).exp();
}

Eigen::MatrixXf solve_ridge(const Eigen::MatrixXf& kernel, const std::vector<int>& view_class,
                            int classes, const std::vector<char>& use) {
  constexpr double ridge = 0.02;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < use.size(); ++i)
    if (use[i]) kept.push_back(static_cast<Eigen::Index>(i));
  const auto n = static_cast<Eigen::Index>(kept.size());
  Eigen::MatrixXd K = kernel(kept, kept).cast<double>();
  K.diagonal().array() += ridge;
  Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(n, classes);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int c = view_class[static_cast<std::size_t>(kept[static_cast<std::size_t>(i)])];
    if (c >= 0) targets(i, c) = 1;
  }
  const Eigen::MatrixXd solved = K.llt().solve(targets);
  Eigen::MatrixXf dual = Eigen::MatrixXf::Zero(kernel.rows(), classes);
  for (Eigen::Index i = 0; i < n; ++i)
    dual.row(kept[static_cast<std::size_t>(i)]) = solved.row(i).cast<float>();
  return dual;
}

}  // namespace prehend::recognition
