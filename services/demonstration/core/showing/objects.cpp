#include "services/demonstration/core/showing/objects.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::demonstration {

namespace {

using model::GraspClass;
using model::GraspForm;
using model::ShapeKind;

constexpr double size_error = 0.03;  // of a size that a camera measures

/// What several fingers hold in a row, m; a disk's height; otherwise how much longer than wide.
constexpr double min_bar = 0.08, max_bar = 0.22, min_disk = 0.01, max_disk = 0.04;
constexpr double max_ratio = 3, max_depth_ratio = 1.8;

double length_of(const GraspClass& kind, double width, Random& random) {
  if (kind.form == GraspForm::prismatic && kind.opposed.size() > 1)
    return random.uniform(min_bar, max_bar);
  if (kind.name.ends_with("disk")) return random.uniform(min_disk, max_disk);
  if (kind.form == GraspForm::flat) return random.uniform(0.04, 0.1);
  return width * random.uniform(1, max_ratio);
}

}  // namespace

model::Shape drawn_object(const GraspClass& kind, Random& random) {
  const ShapeKind shape = kind.shapes[random.index(kind.shapes.size())];
  const double width = std::exp(random.uniform(std::log(kind.min_width), std::log(kind.max_width)));
  const double length = length_of(kind, width, random);
  const double depth = kind.form == GraspForm::flat ? random.uniform(0.02, 0.06)
                                                    : width * random.uniform(1, max_depth_ratio);
  switch (shape) {
    case ShapeKind::box:
      return {shape, {width, depth, length}};
    case ShapeKind::sphere:
      return {shape, Eigen::Vector3d::Constant(width / 2)};
    default:
      return {ShapeKind::cylinder, {width / 2, width / 2, length}};
  }
}

model::Shape measured(model::Shape shape, Random& random) {
  const double width = std::exp(random.normal(size_error));
  const double depth = shape.kind == ShapeKind::box ? std::exp(random.normal(size_error)) : width;
  const double length =
      shape.kind == ShapeKind::sphere ? width : std::exp(random.normal(size_error));
  shape.size = shape.size.cwiseProduct(Eigen::Vector3d(width, depth, length));
  return shape;
}

}  // namespace prehend::demonstration
