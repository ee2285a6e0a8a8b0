#include "scaling.hpp"

#include <utility>

namespace prehend::learning {

namespace {
/// Ranges below this are no variation but rounding.
constexpr double no_range = 1e-12;
}  // namespace

Scaling::Scaling(Eigen::VectorXd minimum, Eigen::VectorXd maximum)
    : minimum_(std::move(minimum)), maximum_(std::move(maximum)) {
  const Eigen::ArrayXd range = (maximum_ - minimum_).array();
  to_ = (range > no_range).select(2.0 / range, 0.0);
  from_ = range / 2.0;
}

Expected<Scaling> Scaling::create(Eigen::VectorXd minimum, Eigen::VectorXd maximum) {
  if (minimum.size() == 0 || minimum.size() != maximum.size())
    return fail("a scaling needs as many minima as maxima");
  if (!minimum.allFinite() || !maximum.allFinite() || (minimum.array() > maximum.array()).any() ||
      !(maximum - minimum).allFinite())
    return fail("a scaling's ranges are not finite or upside down");
  return Scaling(std::move(minimum), std::move(maximum));
}

Expected<Scaling> Scaling::fit(const Eigen::MatrixXd& samples, ScalingKind kind, double margin) {
  if (samples.size() == 0) return fail("nothing to fit a scaling to");
  if (!samples.allFinite()) return fail("samples are not finite");
  Eigen::VectorXd minimum = samples.rowwise().minCoeff();
  Eigen::VectorXd maximum = samples.rowwise().maxCoeff();
  if (kind == ScalingKind::whole_matrix) {
    minimum.setConstant(minimum.minCoeff());
    maximum.setConstant(maximum.maxCoeff());
  }
  const Eigen::VectorXd wider = margin * (maximum - minimum);
  return create(minimum - wider, maximum + wider);
}

Eigen::VectorXd Scaling::to_unit(const Eigen::VectorXd& v) const {
  // A feature without range has factor 0 and must give 0, not 1.
  return (to_ > 0.0).select(1.0 - (v - minimum_).array() * to_, 0.0);
}

Eigen::VectorXd Scaling::from_unit(const Eigen::VectorXd& u) const {
  return minimum_.array() + (1.0 - u.array()) * from_;
}

}  // namespace prehend::learning
