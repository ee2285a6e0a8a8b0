#include "services/demonstration/core/recognition/whitening.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace prehend::demonstration {

namespace {

constexpr double no_deviation = 1e-9;
// Of a feature that nobody measured in training: whatever it is later, it tells nothing.
constexpr double says_nothing = 1e12;

}  // namespace

Expected<Whitening> Whitening::create(Eigen::VectorXd mean, Eigen::VectorXd deviation,
                                      Eigen::MatrixXd turn) {
  if (mean.size() == 0 || mean.size() != deviation.size())
    return fail("a scale needs as many means as deviations");
  if (!mean.allFinite() || !deviation.allFinite() || deviation.minCoeff() <= 0)
    return fail("a scale's means or deviations are no sound numbers");
  if (turn.size() > 0 && (turn.cols() != mean.size() || !turn.allFinite()))
    return fail("a scale's matrix does not fit its means");
  Whitening made;
  made.mean_ = std::move(mean);
  made.deviation_ = std::move(deviation);
  made.turn_ = std::move(turn);
  return made;
}

Expected<Whitening> Whitening::fit(const Eigen::MatrixXd& samples) {
  if (samples.size() == 0) return fail("no samples to learn a scale from");
  Eigen::VectorXd mean(samples.rows()), deviation(samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const double x : samples.row(i))
      if (std::isfinite(x)) sum += x, ++count;
    mean[i] = count > 0 ? sum / count : 0;
    for (const double x : samples.row(i))
      if (std::isfinite(x)) squares += (x - mean[i]) * (x - mean[i]);
    const double spread = count > 1 ? std::sqrt(squares / (count - 1)) : 0;
    deviation[i] = count == 0 ? says_nothing : spread > no_deviation ? spread : 1;
  }
  return create(std::move(mean), std::move(deviation), {});
}

Expected<Whitening> Whitening::fit_within(const Eigen::MatrixXd& samples,
                                          const std::vector<int>& classes, double ridge) {
  auto made = fit(samples);
  if (!made) return made;
  if (classes.size() != static_cast<std::size_t>(samples.cols()))
    return fail("a class is missing for a sample");
  const Eigen::Index n = samples.rows();
  const int count = classes.empty() ? 0 : *std::max_element(classes.begin(), classes.end()) + 1;
  Eigen::MatrixXd scaled(n, samples.cols());
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(n, count);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    scaled.col(i) = made->apply(samples.col(i));
    means.col(classes[static_cast<std::size_t>(i)]) += scaled.col(i);
    ++sizes[classes[static_cast<std::size_t>(i)]];
  }
  for (int c = 0; c < count; ++c) means.col(c) /= std::max(1.0, sizes[c]);
  for (Eigen::Index i = 0; i < samples.cols(); ++i)
    scaled.col(i) -= means.col(classes[static_cast<std::size_t>(i)]);
  Eigen::MatrixXd within = scaled * scaled.transpose() / static_cast<double>(samples.cols());
  within.diagonal().array() += ridge;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(within);
  const Eigen::VectorXd stretch =
      solver.eigenvalues().cwiseMax(no_deviation).cwiseSqrt().cwiseInverse();
  return create(made->mean(), made->deviation(),
                stretch.asDiagonal() * solver.eigenvectors().transpose());
}

Eigen::VectorXd Whitening::apply(const Eigen::VectorXd& x) const {
  Eigen::VectorXd z(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double scaled = (x[i] - mean_[i]) / deviation_[i];
    z[i] = std::isnan(scaled) ? 0 : std::clamp(scaled, -farthest, farthest);
  }
  if (turn_.size() == 0) return z;
  return turn_ * z;
}

}  // namespace prehend::demonstration
