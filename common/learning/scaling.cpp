#include "common/learning/scaling.hpp"

#include <array>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::learning {

namespace {

/// Ranges below this are no variation but rounding.
constexpr double no_range = 1e-12;

constexpr auto kind_names = named_values<ScalingKind>({{ScalingKind::each_feature, "each feature"},
                                                       {ScalingKind::whole_matrix, "whole matrix"},
                                                       {ScalingKind::as_printed, "as printed"}});

}  // namespace

std::string_view to_string(ScalingKind kind) {
  return kind_names.name(kind);
}

std::optional<ScalingKind> scaling_from_string(std::string_view name) {
  return kind_names.value(name);
}

Scaling::Scaling(Eigen::VectorXd minimum, Eigen::VectorXd maximum, ScalingKind kind)
    : minimum_(std::move(minimum)), maximum_(std::move(maximum)), kind_(kind) {
  if (kind_ == ScalingKind::as_printed) {
    from_ = (maximum_ + minimum_).array();
    to_ = from_.inverse();
    return;
  }
  const Eigen::ArrayXd range = (maximum_ - minimum_).array();
  to_ = (range > no_range).select(2.0 / range, 0.0);
  from_ = range / 2.0;
}

Expected<Scaling> Scaling::create(Eigen::VectorXd minimum, Eigen::VectorXd maximum,
                                  ScalingKind kind) {
  if (minimum.size() == 0 || minimum.size() != maximum.size())
    return fail("a scaling needs as many minima as maxima");
  if (!minimum.allFinite() || !maximum.allFinite() || (minimum.array() > maximum.array()).any() ||
      !(maximum - minimum).allFinite())
    return fail("a scaling's ranges are not finite or upside down");
  if (kind == ScalingKind::as_printed &&
      ((maximum + minimum).array().abs() <= no_range || !(maximum + minimum).array().isFinite())
          .any())
    return fail("max + min is zero, and eq. 4.14 as printed divides by it");
  return Scaling(std::move(minimum), std::move(maximum), kind);
}

Expected<Scaling> Scaling::fit(const Eigen::MatrixXd& samples, ScalingKind kind, double margin) {
  if (samples.size() == 0) return fail("nothing to fit a scaling to");
  if (!samples.allFinite()) return fail("samples are not finite");
  Eigen::VectorXd minimum = samples.rowwise().minCoeff();
  Eigen::VectorXd maximum = samples.rowwise().maxCoeff();
  if (kind != ScalingKind::each_feature) {
    minimum.setConstant(minimum.minCoeff());
    maximum.setConstant(maximum.maxCoeff());
  }
  const Eigen::VectorXd wider = margin * (maximum - minimum);
  return create(minimum - wider, maximum + wider, kind);
}

Eigen::VectorXd Scaling::to_unit(const Eigen::VectorXd& v) const {
  if (kind_ == ScalingKind::as_printed) return (from_ - (v.array() + minimum_.array().abs())) * to_;
  // A feature without range has factor 0 and must give 0, not 1.
  return (to_ > 0.0).select(1.0 - (v - minimum_).array() * to_, 0.0);
}

Eigen::VectorXd Scaling::from_unit(const Eigen::VectorXd& u) const {
  if (kind_ == ScalingKind::as_printed) return from_ - (u.array() - minimum_.array().abs()) * from_;
  return minimum_.array() + (1.0 - u.array()) * from_;
}

}  // namespace prehend::learning
