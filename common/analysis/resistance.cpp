#include "common/analysis/resistance.hpp"

#include "common/analysis/nearest_facet.hpp"

namespace prehend::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Expected<Resistance> nearest(Index dimension, const Support& support) {
  const auto facet = nearest_facet(static_cast<int>(dimension), support);
  if (!facet) return tl::unexpected(facet.error());
  if (!*facet) return resistance_at(0, VectorXd::Zero(dimension));
  return resistance_at((*facet)->distance, (*facet)->normal);
}

}  // namespace

Resistance resistance_at(double distance, const VectorXd& normal) {
  if (!(distance >= min_epsilon)) return {-1, false, VectorXd::Zero(normal.size())};
  // The grasp can push least along the outward normal, so a load the other way is hardest.
  return {distance, true, -normal};
}

Expected<Resistance> l1_resistance(const MatrixXd& wrenches) {
  if (!wrenches.allFinite()) return fail("wrenches must be finite");
  if (wrenches.cols() <= wrenches.rows()) return resistance_at(0, VectorXd::Zero(wrenches.rows()));
  return nearest(wrenches.rows(), [&](const VectorXd& direction) -> VectorXd {
    Index farthest = 0;
    (direction.transpose() * wrenches).maxCoeff(&farthest);
    return wrenches.col(farthest);
  });
}

Expected<Resistance> linf_resistance(const std::vector<MatrixXd>& contact_wrenches) {
  if (contact_wrenches.empty()) return resistance_at(0, VectorXd::Zero(6));
  const Index dimension = contact_wrenches.front().rows();
  for (const MatrixXd& wrenches : contact_wrenches)
    if (!wrenches.allFinite() || wrenches.rows() != dimension || wrenches.cols() == 0)
      return fail("wrenches must be finite, of one dimension, at least one a contact");
  return nearest(dimension, [&](const VectorXd& direction) -> VectorXd {
    VectorXd sum = VectorXd::Zero(dimension);
    for (const MatrixXd& wrenches : contact_wrenches) {
      Index farthest = 0;
      if ((direction.transpose() * wrenches).maxCoeff(&farthest) > 0) sum += wrenches.col(farthest);
    }
    return sum;
  });
}

}  // namespace prehend::analysis
