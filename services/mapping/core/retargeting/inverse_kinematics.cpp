#include "services/mapping/core/retargeting/inverse_kinematics.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace prehend::mapping {

using Eigen::Index;
using Eigen::Map;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// At a limit and pushed further out.
bool is_stopped(const model::HandDof& dof, double value, double push) {
  return (value <= dof.lower && push < 0) || (value >= dof.upper && push > 0);
}

}  // namespace

VectorXd reach(const FollowingTips& tips, const Matrix3Xd& p_GT, const VectorXd& start,
               const InverseKinematicsOptions& options) {
  const model::HandModel& hand = tips.hand();
  const VectorXd from = hand.clamp(start);
  VectorXd dof = from;
  MatrixXd jacobian;
  const auto miss = [&](const Matrix3Xd& now) -> VectorXd {
    const Matrix3Xd difference = p_GT - now;
    return Map<const VectorXd>(difference.data(), difference.size());
  };
  const auto cost = [&](const VectorXd& e, const VectorXd& q) {
    return e.squaredNorm() + options.stay * (q - from).squaredNorm();
  };
  VectorXd e = miss(tips.positions(dof, jacobian));
  double least = cost(e, dof);
  double damping = options.damping;
  for (int i = 0; i < options.iterations && damping < 10; ++i) {
    // Normal equations of the DoFs that are free to move.
    const VectorXd push = jacobian.transpose() * e - options.stay * (dof - from);
    MatrixXd A = jacobian.transpose() * jacobian;
    A.diagonal().array() += options.stay + damping * damping;
    VectorXd b = push;
    for (Index k = 0; k < dof.size(); ++k) {
      if (!is_stopped(hand.dofs()[static_cast<std::size_t>(k)], dof[k], push[k])) continue;
      A.row(k).setZero();
      A.col(k).setZero();
      A(k, k) = 1;
      b[k] = 0;
    }
    const VectorXd next = hand.clamp(dof + A.ldlt().solve(b));
    MatrixXd next_jacobian;
    const VectorXd next_e = miss(tips.positions(next, next_jacobian));
    const double next_cost = cost(next_e, next);
    if (!(next_cost < least)) {
      damping *= 3;
      continue;
    }
    const double nearer = std::sqrt(least) - std::sqrt(next_cost);
    dof = next;
    e = next_e;
    jacobian = std::move(next_jacobian);
    least = next_cost;
    damping = std::max(options.damping, damping / 3);
    if (nearer < options.nearer) break;
  }
  return dof;
}

}  // namespace prehend::mapping
