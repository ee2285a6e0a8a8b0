#include "services/mapping/core/retargeting/vector_matching.hpp"

#include <nlopt.h>

#include <memory>

namespace prehend::mapping {

using Eigen::Index;
using Eigen::Map;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

struct Objective {
  const FollowingTips& tips;
  const Matrix3Xd& vectors_G;
  const VectorXd& before;
  const VectorMatchingOptions& options;
  Vector3d p_GB;
  MatrixXd jacobian;

  double evaluate(const VectorXd& dof, double* gradient) {
    const Matrix3Xd p_GT = tips.positions(dof, jacobian);
    const double share = 1.0 / tips.count();
    double sum = options.smoothness * (dof - before).squaredNorm();
    VectorXd slope = 2 * options.smoothness * (dof - before);
    for (int i = 0; i < tips.count(); ++i) {
      const Vector3d miss = p_GT.col(i) - p_GB - vectors_G.col(i);
      const double length = miss.norm();
      const bool near = length < options.huber;
      sum += share * (near ? 0.5 * length * length / options.huber : length - 0.5 * options.huber);
      // Derivative of the loss by the length, over the length.
      const double per_length = 1 / (near ? options.huber : length);
      slope += share * per_length * jacobian.middleRows<3>(3 * i).transpose() * miss;
    }
    if (gradient) Map<VectorXd>(gradient, slope.size()) = slope;
    return sum;
  }
};

double call(unsigned count, const double* x, double* gradient, void* objective) {
  return static_cast<Objective*>(objective)->evaluate(Map<const VectorXd>(x, count), gradient);
}

}  // namespace

VectorXd match_vectors(const FollowingTips& tips, const Matrix3Xd& vectors_G,
                       const VectorXd& before, const VectorMatchingOptions& options) {
  const model::HandModel& hand = tips.hand();
  const auto count = static_cast<unsigned>(hand.dofs().size());
  VectorXd lower(count), upper(count);
  for (unsigned i = 0; i < count; ++i) {
    lower[i] = hand.dofs()[i].lower;
    upper[i] = hand.dofs()[i].upper;
  }
  Objective objective{tips,      vectors_G, before, options, hand.X_BG().inverse().translation(),
                      MatrixXd()};
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> solver(
      nlopt_create(NLOPT_LD_SLSQP, count), &nlopt_destroy);
  nlopt_set_min_objective(solver.get(), &call, &objective);
  nlopt_set_lower_bounds(solver.get(), lower.data());
  nlopt_set_upper_bounds(solver.get(), upper.data());
  nlopt_set_ftol_abs(solver.get(), options.precision);
  nlopt_set_maxeval(solver.get(), options.evaluations);
  VectorXd dof = hand.clamp(before);
  const double unchanged = objective.evaluate(dof, nullptr);
  double reached = unchanged;
  // Its codes only tell why it stopped; rounding may end it early with the best that it has.
  nlopt_optimize(solver.get(), dof.data(), &reached);
  if (!dof.allFinite() || !(objective.evaluate(dof, nullptr) <= unchanged)) dof = before;
  return hand.clamp(dof);
}

}  // namespace prehend::mapping
