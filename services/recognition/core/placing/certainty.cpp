#include "services/recognition/core/placing/certainty.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace prehend::recognition {

Eigen::Matrix3d covariance(const Evidence& evidence, const CameraModel& camera,
                           const model::Shape& shape, const TablePose& at) {
  const Eigen::Vector3d h(0.004, 0.004, 0.07);
  const auto value = [&](const Eigen::Vector3d& d) {
    const auto region = silhouette(camera, shape, {at.x + d.x(), at.y + d.y(), at.yaw + d.z()});
    return region ? 0.1 * evidence.sum(*region) : -1e17;
  };
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const double middle = value(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
      a[i] = h[i];
      b[j] = h[j];
      const double second = i == j
                                ? value(a) - 2 * middle + value(-a)
                                : (value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / 4;
      information(i, j) = information(j, i) = -second / (h[i] * h[j]);
    }
  if (!information.allFinite()) information.setZero();
  // Clamp to what is positive and within what was searched: 5 cm and a quarter turn at most.
  Eigen::Matrix3d scaled = h.asDiagonal() * information * h.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled);
  const Eigen::Vector3d kept = eigen.eigenvalues().cwiseMax(0.01);
  const Eigen::Matrix3d inverse =
      eigen.eigenvectors() * kept.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  Eigen::Matrix3d made = h.asDiagonal() * inverse * h.asDiagonal();
  made.diagonal() += Eigen::Vector3d(4e-7, 4e-7, 2e-5);
  if (shape.kind != model::ShapeKind::box) {
    made.row(2).setZero();
    made.col(2).setZero();
    made(2, 2) = std::numbers::pi * std::numbers::pi / 3;  // any turn
  }
  return made;
}

Eigen::Vector2d measured_size(const Evidence& evidence, const CameraModel& camera,
                              const model::Shape& shape, const TablePose& at) {
  const auto best = [&](bool height) {
    double most = -1e18, ratio = 1;
    for (int k = -8; k <= 8; ++k) {
      const double factor = std::exp(0.05 * k);  // 0.67 to 1.5
      model::Shape changed = shape;
      if (height || shape.kind == model::ShapeKind::sphere) changed.size.z() *= factor;
      if (!height || shape.kind == model::ShapeKind::sphere) changed.size.head<2>() *= factor;
      const auto region = silhouette(camera, changed, at);
      const double value = region ? evidence.sum(*region) : -1e18;
      // Of equals the one nearest to what is known.
      if (value > most + 1e-9 || (value > most - 1e-9 && factor <= 1)) {
        most = value;
        ratio = factor;
      }
    }
    return ratio;
  };
  return {best(false), best(true)};
}

}  // namespace prehend::recognition
