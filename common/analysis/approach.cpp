#include "common/analysis/approach.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace prehend::analysis {

double skewness(const Eigen::Matrix3d& second_moments_O, const Eigen::Vector3d& approach_O) {
  constexpr double same = 1e-6;  // of the largest: moments that count as equal
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(second_moments_O);
  const Eigen::Vector3d moments = axes.eigenvalues();  // ascending
  const Eigen::Array3d share =
      (axes.eigenvectors().transpose() * approach_O.normalized()).array().square();
  double greatest = 0, together = 0;  // squared cosine of the angle to an axis or a plane of axes
  for (Eigen::Index i = 0; i < 3; ++i) {
    const bool joined = i > 0 && moments[i] - moments[i - 1] <= same * moments[2];
    together = joined ? together + share[i] : share[i];
    greatest = std::max(greatest, together);
  }
  return std::acos(std::sqrt(std::clamp(greatest, 0.0, 1.0)));
}

double skewness(const model::Shape& shape, const Eigen::Vector3d& approach_O) {
  Eigen::Vector3d moments =
      model::half_extents(shape).array().square() / 3;                 // a box, a volume of 1
  if (model::is_upright_round(shape.kind)) moments.head<2>() *= 0.75;  // r²/4
  return skewness(Eigen::Matrix3d(moments.asDiagonal()), approach_O);
}

}  // namespace prehend::analysis
