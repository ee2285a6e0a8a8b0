#include "services/demonstration/core/recognition/object_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::demonstration {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unseen = 0.5;          // takes, of a shape that nobody has shown
constexpr double shape_count = 3;       // there are
constexpr std::size_t min_takes = 5;    // to say how large objects are
constexpr double min_deviation = 0.05;  // of a logarithm: sizes are measured no better
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

Expected<ObjectLikelihood> ObjectLikelihood::learn(const std::vector<const Take*>& takes,
                                                   const std::vector<std::string>& classes) {
  std::map<std::pair<std::size_t, model::ShapeKind>, std::vector<VectorXd>> shown;
  std::vector<double> counts(classes.size());
  for (const Take* take : takes) {
    const auto found = std::find(classes.begin(), classes.end(), take->label);
    if (!take->object || found == classes.end()) continue;
    const auto kind = static_cast<std::size_t>(found - classes.begin());
    shown[{kind, take->object->kind}].push_back(logarithms(*take->object));
    ++counts[kind];
  }
  if (shown.empty())
    return fail("no object was measured", {}, "takes need the columns shape and size_x_cm, ...");
  ObjectLikelihood made;
  for (const double count : counts)
    made.otherwise_.push_back(unseen / (count + shape_count * unseen));
  for (const auto& [group, sizes] : shown) {
    Sizes learnt;
    learnt.share =
        (static_cast<double>(sizes.size()) + unseen) / (counts[group.first] + shape_count * unseen);
    if (sizes.size() >= min_takes) {
      MatrixXd all(sizes.front().size(), static_cast<Index>(sizes.size()));
      for (std::size_t i = 0; i < sizes.size(); ++i) all.col(static_cast<Index>(i)) = sizes[i];
      learnt.means = all.rowwise().mean();
      learnt.variances = ((all.colwise() - learnt.means).rowwise().squaredNorm() /
                          static_cast<double>(sizes.size() - 1))
                             .cwiseMax(min_deviation * min_deviation);
    }
    made.sizes_.emplace(group, std::move(learnt));
  }
  return made;
}

VectorXd ObjectLikelihood::of(const model::Shape& object) const {
  const VectorXd sizes = logarithms(object);
  const double any = any_size(sizes);
  VectorXd made(static_cast<Index>(otherwise_.size()));
  for (std::size_t c = 0; c < otherwise_.size(); ++c) {
    const auto found = sizes_.find({c, object.kind});
    const double share = found == sizes_.end() ? otherwise_[c] : found->second.share;
    double own = any;
    if (found != sizes_.end() && found->second.means.size() > 0) {
      own = 1;
      for (Index i = 0; i < sizes.size(); ++i)
        own *= normal(sizes[i], found->second.means[i], found->second.variances[i]);
    }
    made[static_cast<Index>(c)] = share * ((1 - surprise) * own + surprise * any);
  }
  return made;
}

}  // namespace prehend::demonstration
