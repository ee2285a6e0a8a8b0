#include "services/demonstration/core/recognition/object_likelihood.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/demonstration/core/recognition/features.hpp"

namespace prehend::demonstration {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unseen = 0.5;          // takes, of a shape that nobody has shown
constexpr double shapes = 3;            // there are
constexpr double ridge = 1;             // takes, that say that the hand says nothing
constexpr Index min_takes = 5;          // to say how large objects are
constexpr double min_deviation = 0.03;  // of a logarithm: sizes are measured no better
constexpr double usual_size = 0.05;     // m
constexpr double any_deviation = 1.0;   // of the logarithm of any object's size
constexpr double surprise = 0.01;       // share of objects that are of any size

/// Of its sizes those that are its own.
VectorXd logarithms(const model::Shape& object) {
  switch (object.kind) {
    case model::ShapeKind::sphere:
      return object.size.head<1>().array().log();
    case model::ShapeKind::cylinder:
      return Eigen::Vector2d(object.size.x(), object.size.z()).array().log();
    default:
      return object.size.array().log();
  }
}

double normal(double x, double mean, double variance) {
  const double d = x - mean;
  return std::exp(-0.5 * d * d / variance) / std::sqrt(2 * std::numbers::pi * variance);
}

double any_size(const VectorXd& sizes) {
  double made = 1;
  for (const double size : sizes)
    made *= normal(size, std::log(usual_size), any_deviation * any_deviation);
  return made;
}

}  // namespace

VectorXd ObjectLikelihood::regressors(const HandSample& hand) const {
  if (beside_ == Beside::nothing) return VectorXd::Ones(1);
  const VectorXd shown = scale_->apply(features(hand, Inputs::posture));
  VectorXd made(1 + shown.size());
  made << 1, shown;
  return made;
}

/// Ridge regression; the constant is free. A row a take.
ObjectLikelihood::Sizes ObjectLikelihood::sizes_of(const MatrixXd& regressors,
                                                   const MatrixXd& sizes) {
  Sizes made;
  if (sizes.rows() < min_takes) return made;
  MatrixXd normal_matrix = regressors.transpose() * regressors;
  normal_matrix.diagonal().tail(normal_matrix.rows() - 1).array() += ridge;
  made.uncertainty =
      normal_matrix.ldlt().solve(MatrixXd::Identity(normal_matrix.rows(), normal_matrix.cols()));
  made.coefficients = made.uncertainty * (regressors.transpose() * sizes);
  const MatrixXd rest = sizes - regressors * made.coefficients;
  // Parameters that were fitted explain some of the rest.
  const double fitted = (made.uncertainty * regressors.transpose() * regressors).trace();
  const double free = std::max(1.0, static_cast<double>(sizes.rows()) - fitted);
  made.variances =
      (rest.colwise().squaredNorm().transpose() / free).cwiseMax(min_deviation * min_deviation);
  return made;
}

Expected<ObjectLikelihood> ObjectLikelihood::learn(const std::vector<const Take*>& takes,
                                                   const std::vector<std::string>& classes,
                                                   Beside beside) {
  std::map<std::pair<std::size_t, model::ShapeKind>, std::vector<const Take*>> groups;
  std::vector<double> counts(classes.size());
  std::vector<VectorXd> hands;
  for (const Take* take : takes) {
    const auto found = std::find(classes.begin(), classes.end(), take->label);
    if (!take->object || take->samples.empty() || found == classes.end()) continue;
    const auto kind = static_cast<std::size_t>(found - classes.begin());
    groups[{kind, take->object->kind}].push_back(take);
    ++counts[kind];
    hands.push_back(features(take->samples.back(), Inputs::posture));
  }
  if (hands.empty())
    return fail("no object was measured", {}, "takes need the columns shape and size_x_cm, ...");
  ObjectLikelihood made;
  made.beside_ = beside;
  MatrixXd all(hands.front().size(), static_cast<Index>(hands.size()));
  for (std::size_t i = 0; i < hands.size(); ++i) all.col(static_cast<Index>(i)) = hands[i];
  auto scale = Whitening::fit(all);
  if (!scale) return tl::unexpected(scale.error());
  made.scale_ = std::move(*scale);
  for (const double count : counts) made.otherwise_.push_back(unseen / (count + shapes * unseen));
  for (const auto& [group, own] : groups) {
    const auto n = static_cast<Index>(own.size());
    MatrixXd shown(n, made.regressors(own.front()->samples.back()).size());
    MatrixXd sizes(n, logarithms(*own.front()->object).size());
    for (Index i = 0; i < n; ++i) {
      const Take& take = *own[static_cast<std::size_t>(i)];
      shown.row(i) = made.regressors(take.samples.back());
      sizes.row(i) = logarithms(*take.object);
    }
    Sizes learnt = sizes_of(shown, sizes);
    learnt.share = (static_cast<double>(n) + unseen) / (counts[group.first] + shapes * unseen);
    made.sizes_.emplace(group, std::move(learnt));
  }
  return made;
}

VectorXd ObjectLikelihood::of(const model::Shape& object, const HandSample& hand) const {
  const VectorXd shown = regressors(hand), sizes = logarithms(object);
  const double any = any_size(sizes);
  VectorXd made(static_cast<Index>(otherwise_.size()));
  for (std::size_t c = 0; c < otherwise_.size(); ++c) {
    const auto found = sizes_.find({c, object.kind});
    double& answer = made[static_cast<Index>(c)];
    if (found == sizes_.end() || found->second.coefficients.size() == 0) {
      answer = any * (found == sizes_.end() ? otherwise_[c] : found->second.share);
      continue;
    }
    const Sizes& known = found->second;
    const VectorXd mean = known.coefficients.transpose() * shown;
    const double wider = 1 + shown.dot(known.uncertainty * shown);
    double own = 1;
    for (Index i = 0; i < sizes.size(); ++i)
      own *= normal(sizes[i], mean[i], known.variances[i] * wider);
    answer = known.share * ((1 - surprise) * own + surprise * any);
  }
  return made;
}

}  // namespace prehend::demonstration
