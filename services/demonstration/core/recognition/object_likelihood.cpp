#include "services/demonstration/core/recognition/object_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace prehend::demonstration {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unseen = 0.5;        // takes, of a shape that nobody has shown
constexpr double shape_count = 3;     // there are
constexpr std::size_t min_takes = 5;  // to say how large objects are
// How far an object that was shown speaks for others at least, logarithm: its width decides, and is
// measured within a few per cent; how long and deep such things are says less.
constexpr double of_width = 0.05, of_others = 0.15;
constexpr double usual_size = 0.05;    // m
constexpr double any_deviation = 1.0;  // of the logarithm of any object's size
constexpr double surprise = 0.01;      // share of objects that are of any size

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

/// At least as far as its neighbours are apart, where sizes are evenly spread.
VectorXd reach_of(const MatrixXd& shown) {
  VectorXd made = VectorXd::Constant(shown.rows(), of_others);
  if (made.size() > 0) made[0] = of_width;
  if (shown.cols() == 0) return made;
  const auto n = static_cast<double>(shown.cols());
  for (Index i = 0; i < made.size(); ++i) {
    const double deviation =
        std::sqrt((shown.row(i).array() - shown.row(i).mean()).square().mean());
    made[i] = std::max(made[i], std::sqrt(12.0) * deviation / n);
  }
  return made;
}

/// The density of sizes beside these, each spread over those near it.
double near(const VectorXd& sizes, const MatrixXd& shown, const VectorXd& reach) {
  double sum = 0;
  for (const auto& each : shown.colwise()) {
    double density = 1;
    for (Index i = 0; i < sizes.size(); ++i)
      density *= normal(sizes[i], each[i], reach[i] * reach[i]);
    sum += density;
  }
  return sum / static_cast<double>(shown.cols());
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
  std::vector<double> otherwise;
  for (const double count : counts) otherwise.push_back(unseen / (count + shape_count * unseen));
  std::vector<Sizes> all;
  for (const auto& [group, sizes] : shown) {
    Sizes learnt{group.first, group.second, 0, {}, {}};
    learnt.share =
        (static_cast<double>(sizes.size()) + unseen) / (counts[group.first] + shape_count * unseen);
    if (sizes.size() >= min_takes) {
      learnt.shown.resize(sizes.front().size(), static_cast<Index>(sizes.size()));
      for (std::size_t i = 0; i < sizes.size(); ++i)
        learnt.shown.col(static_cast<Index>(i)) = sizes[i];
    }
    all.push_back(std::move(learnt));
  }
  return create(std::move(all), std::move(otherwise));
}

Expected<ObjectLikelihood> ObjectLikelihood::create(std::vector<Sizes> sizes,
                                                    std::vector<double> otherwise) {
  const auto is_share = [](double share) { return share > 0 && share <= 1; };
  if (!std::all_of(otherwise.begin(), otherwise.end(), is_share))
    return fail("a share of shapes is not above 0");
  for (Sizes& each : sizes) {
    if (each.kind >= otherwise.size()) return fail("sizes of objects are of no class");
    if (!is_share(each.share)) return fail("a share of shapes is not above 0");
    const Index own = logarithms({each.shape, Eigen::Vector3d::Ones()}).size();
    if (!each.shown.allFinite() || (each.shown.size() > 0 && each.shown.rows() != own))
      return fail("sizes of objects do not fit their shape");
    each.reach = reach_of(each.shown);
  }
  ObjectLikelihood made;
  made.sizes_ = std::move(sizes);
  made.otherwise_ = std::move(otherwise);
  return made;
}

VectorXd ObjectLikelihood::of(const model::Shape& seen) const {
  // Nobody has shown cones: as what they are like.
  const bool cone = seen.kind == model::ShapeKind::cone;
  const model::Shape object = cone ? model::like_known(seen) : seen;
  const VectorXd sizes = logarithms(object);
  const double any = any_size(sizes);
  VectorXd made(static_cast<Index>(otherwise_.size()));
  for (Index c = 0; c < made.size(); ++c) made[c] = otherwise_[static_cast<std::size_t>(c)] * any;
  for (const Sizes& each : sizes_) {
    if (each.shape != object.kind) continue;
    const double own = each.shown.size() > 0 ? near(sizes, each.shown, each.reach) : any;
    made[static_cast<Index>(each.kind)] = each.share * ((1 - surprise) * own + surprise * any);
  }
  return made;
}

}  // namespace prehend::demonstration
