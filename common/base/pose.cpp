#include "common/base/pose.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace prehend {

Pose make_pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  return make_pose(p, q.toRotationMatrix());
}

Pose make_pose(const Eigen::Vector3d& p, const Eigen::Matrix3d& R) {
  Pose X = Pose::Identity();
  X.translation() = p;
  X.linear() = R;
  return X;
}

Expected<Pose> checked_pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  if (!p.allFinite() || !q.coeffs().allFinite()) return fail("pose is not finite");
  if (q.norm() < 1e-6) return fail("rotation has zero norm");
  return make_pose(p, q.normalized());
}

Expected<Eigen::Matrix3d> nearest_rotation(const Eigen::Matrix3d& M) {
  if (!M.allFinite()) return fail("rotation is not finite");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if ((svd.singularValues().array() - 1.0).abs().maxCoeff() > 0.2)
    return fail("matrix is no rotation");
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  if (R.determinant() < 0) return fail("matrix is a reflection");
  return R;
}

bool is_finite(const Pose& X) {
  return X.matrix().allFinite();
}

double angle_between(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B) {
  return Eigen::AngleAxisd(A.transpose() * B).angle();
}

Pose interpolate(const Pose& A, const Pose& B, double t) {
  const Eigen::Quaterniond qa(A.linear()), qb(B.linear());
  return make_pose((1.0 - t) * A.translation() + t * B.translation(), qa.slerp(t, qb));
}

Pose limit_step(const Pose& A, const Pose& B, double distance, double angle) {
  const Eigen::Vector3d step = B.translation() - A.translation();
  const Eigen::AngleAxisd turn(A.linear().transpose() * B.linear());
  const double length = step.norm();
  const Eigen::Vector3d p = length > distance
                                ? Eigen::Vector3d(A.translation() + step * (distance / length))
                                : Eigen::Vector3d(B.translation());
  const Eigen::Matrix3d R =
      turn.angle() > angle
          ? Eigen::Matrix3d(A.linear() * Eigen::AngleAxisd(angle, turn.axis()).toRotationMatrix())
          : Eigen::Matrix3d(B.linear());
  return make_pose(p, R);
}

}  // namespace prehend
