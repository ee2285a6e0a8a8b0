#include "common/model/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace prehend::model {

Eigen::Matrix3d grasp_axes(const Eigen::Vector3d& approach, const Eigen::Vector3d& closing) {
  Eigen::Matrix3d R;
  R.col(2) = approach;
  R.col(1) = closing;
  R.col(0) = closing.cross(approach);
  return R;
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Keeps the better of the candidates: turned least, then moved least.
struct Nearest {
  const Pose& X_OG;
  std::optional<Pose> best;
  double cost = std::numeric_limits<double>::infinity();

  void offer(const Matrix3d& R, const Vector3d& p) {
    const double candidate =
        angle_between(X_OG.linear(), R) + (X_OG.translation() - p).norm();  // 1 rad weighs as 1 m
    if (candidate < cost) {
      cost = candidate;
      best = make_pose(p, R);
    }
  }
};

/// Height of G over the bottom of the object when it comes from above; none where the fingers, kept
/// off the table, would meet above the object.
std::optional<double> height_from_above(double height, const Reach& reach) {
  if (reach.clearance > height) return std::nullopt;
  return std::max(height - reach.engage, reach.clearance);
}

/// Horizontal direction of v, or `otherwise` when v is vertical.
Vector3d horizontal(const Vector3d& v, const Vector3d& otherwise) {
  const Vector3d flat(v.x(), v.y(), 0);
  return flat.norm() < 1e-9 ? otherwise : Vector3d(flat.normalized());
}

/// Levels at which something round is no wider than this, within from and to; none: an empty range.
struct Levels {
  double from, to;
};
Levels narrow_enough(const Shape& shape, double width, Levels within) {
  const auto fits = [&](double z) { return 2 * radius_at(shape, z) <= width; };
  const double rise = 2 * slope(shape);
  if (std::abs(rise) < 1e-9) return fits(0) ? within : Levels{1, -1};
  const double edge = (width - 2 * radius_at(shape, 0)) / rise;  // where it is just as wide
  return rise > 0 ? Levels{within.from, std::min(within.to, edge)}
                  : Levels{std::max(within.from, edge), within.to};
}

/// A cylinder or a cone.
void offer_round(const Shape& shape, const Reach& reach, Nearest& nearest) {
  const double height = shape.size.z();
  const Matrix3d& R = nearest.X_OG.linear();
  const Vector3d p = nearest.X_OG.translation();
  const Vector3d down = -Vector3d::UnitZ();

  // Fingers that come from above pass all that is over where they close.
  const auto above = height_from_above(height, reach);
  const Levels admitted = narrow_enough(shape, reach.opening, {-height, 0.5 * height});
  if (above && admitted.from <= *above - 0.5 * height && admitted.to >= 0.5 * height)
    nearest.offer(grasp_axes(down, horizontal(R.col(1), Vector3d::UnitY())),
                  Vector3d(0, 0, *above - 0.5 * height));
  // From the side the palm's width must find room above the table and some of the object to hold.
  const Levels side =
      narrow_enough(shape, reach.opening, {reach.half_width - 0.5 * height, 0.5 * height - 0.03});
  if (side.from > side.to) return;
  const Vector3d toward_axis = horizontal(R.col(2), Vector3d::UnitX());
  const Vector3d sideways = Vector3d::UnitZ().cross(toward_axis);
  const double level = std::clamp(p.z(), side.from, side.to);
  for (const double sign : {1.0, -1.0})
    nearest.offer(grasp_axes(toward_axis, sign * sideways), Vector3d(0, 0, level));
}

void offer_box(const Shape& shape, const Reach& reach, Nearest& nearest) {
  const Vector3d half = 0.5 * shape.size;
  const Vector3d p = nearest.X_OG.translation();
  for (int closing = 0; closing < 2; ++closing) {
    if (shape.size[closing] > reach.opening) continue;
    const int along = 1 - closing;
    for (const double sign : {1.0, -1.0}) {
      const Vector3d closing_direction = sign * Vector3d::Unit(closing);
      // From above: anywhere along the side, but with the palm over the object.
      Vector3d place = Vector3d::Zero();
      const double slack = std::max(0.0, half[along] - reach.half_width);
      place[along] = std::clamp(p[along], -slack, slack);
      if (const auto above = height_from_above(shape.size.z(), reach)) {
        place.z() = *above - half.z();
        nearest.offer(grasp_axes(-Vector3d::UnitZ(), closing_direction), place);
      }
      // From either end, with the palm upright.
      const double lowest = reach.half_width - half.z();
      const double highest = half.z() - 0.03;
      if (lowest > highest) continue;
      for (const double side : {1.0, -1.0}) {
        Vector3d end = Vector3d::Zero();
        end[along] = -side * std::max(0.0, half[along] - reach.engage);
        end.z() = std::clamp(p.z(), lowest, highest);
        nearest.offer(grasp_axes(side * Vector3d::Unit(along), closing_direction), end);
      }
    }
  }
}

}  // namespace

std::optional<Pose> nearest_grasp(const Shape& shape, const Pose& X_OG, const Reach& reach) {
  if (!is_valid(shape) || !is_finite(X_OG)) return std::nullopt;
  Nearest nearest{X_OG, std::nullopt};
  if (shape.kind == ShapeKind::box) {
    offer_box(shape, reach, nearest);
  } else {
    offer_round(is_upright_round(shape.kind) ? shape : like_known(shape), reach, nearest);
  }
  return nearest.best;
}

}  // namespace prehend::model
