#include "services/glove/core/calibration/registration.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "common/base/toml_text.hpp"

namespace prehend::glove {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double min_spread = 0.03;  // m
constexpr double max_off = 0.03;     // m

Matrix3Xd columns(const std::vector<Vector3d>& points) {
  Matrix3Xd matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  return matrix;
}

/// RMS distance of centred points from the line that fits them best, m.
double spread_across(const Matrix3Xd& centred) {
  // Of the scatter, which is 3x3: the decomposition of all points takes ten times longer to
  // compile.
  const Matrix3d scatter = centred * centred.transpose() / static_cast<double>(centred.cols());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(scatter, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
}

}  // namespace

Expected<Registration> register_tracker(const std::vector<Vector3d>& p_W,
                                        const std::vector<Vector3d>& p_T) {
  if (p_W.size() != p_T.size() || p_W.size() < 3)
    return fail("at least three points are needed", "registration", "touch four that span an area");
  const Matrix3Xd W = columns(p_W), T = columns(p_T);
  if (!W.allFinite() || !T.allFinite()) return fail("a point is not finite", "registration");
  const Vector3d mean_W = W.rowwise().mean(), mean_T = T.rowwise().mean();
  const Matrix3Xd centred_W = W.colwise() - mean_W, centred_T = T.colwise() - mean_T;
  if (spread_across(centred_W) < min_spread || spread_across(centred_T) < min_spread)
    return fail("the points lie nearly on one line or on each other", "registration",
                "choose points that span an area");
  const Eigen::JacobiSVD<Matrix3d> svd(centred_W * centred_T.transpose(),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d proper = Vector3d::Ones();
  proper.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3d R = svd.matrixU() * proper.asDiagonal() * svd.matrixV().transpose();
  Registration result{make_pose(mean_W - R * mean_T, R), 0, 0};
  for (std::size_t i = 0; i < p_W.size(); ++i) {
    const double off = (result.X_WT * p_T[i] - p_W[i]).norm();
    result.residual += off * off / static_cast<double>(p_W.size());
    result.worst = std::max(result.worst, off);
  }
  result.residual = std::sqrt(result.residual);
  if (result.worst > max_off)
    return fail(fmt::format("a point is {:.0f} mm off: what was touched is not the figure that is "
                            "known",
                            1000 * result.worst),
                "registration", "touch the points in their order");
  return result;
}

std::string x_wt_line(const Pose& X_WT) {
  const Vector3d p = X_WT.translation();
  const Eigen::Quaterniond q(X_WT.linear());
  return fmt::format("X_WT = [{:.5f}, {:.5f}, {:.5f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}]", p.x(),
                     p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

}  // namespace prehend::glove
