#include "services/cli/tools/demo/pressing.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace prehend::cli {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

/// Points all over the surface of a solid, in its frame.
std::vector<Vector3d> points_of(const model::Shape& shape) {
  constexpr int turns = 48, rings = 25;
  const Vector3d half = model::half_extents(shape);
  std::vector<Vector3d> points;
  for (int ring = 0; ring < rings; ++ring) {
    const double share = -1 + 2.0 * ring / (rings - 1);  // of the height
    for (int turn = 0; turn < turns; ++turn) {
      const double angle = 2 * std::numbers::pi * turn / turns;
      const Vector3d round(std::cos(angle), std::sin(angle), 0), up(0, 0, share);
      if (shape.kind == model::ShapeKind::sphere)
        points.push_back(half.x() * (std::sqrt(1 - share * share) * round + up));
      else if (shape.kind == model::ShapeKind::box)  // round a square
        points.push_back(half.cwiseProduct(round / round.cwiseAbs().maxCoeff() + up));
      else
        points.push_back(model::radius_at(shape, share * half.z()) * round + half.z() * up);
    }
  }
  return points;
}

/// All over the open hand, in G.
std::vector<Vector3d> points_of(const model::HandModel& hand) {
  const auto X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  std::vector<Vector3d> points;
  for (std::size_t link = 0; link < X_BL.size(); ++link)
    for (const model::CollisionShape& part : hand.links()[link].collision) {
      const Pose X_GS = hand.X_BG().inverse() * X_BL[link] * part.X_LS;
      for (const Vector3d& point : points_of(part.shape)) points.push_back(X_GS * point);
    }
  return points;
}

/// Where a convex function of [-most, most] is least.
template <class F>
double least(double most, F f) {
  double from = -most, to = most;
  for (int i = 0; i < 18; ++i) {  // to a thousandth of it
    const double third = (to - from) / 3;
    if (f(from + third) < f(to - third))
      to -= third;
    else
      from += third;
  }
  return 0.5 * (from + to);
}

/// The slopes of the plane z = height + slopes · (x, y) over all points that is lowest at the
/// origin: what lies on it is all round the axis z, as far as slopes of at most 0.7 allow.
Vector2d resting_slopes(const std::vector<Vector3d>& points) {
  constexpr double most = 0.7;
  const auto height = [&](double a, double b) {
    double z = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : points) z = std::max(z, p.z() - a * p.x() - b * p.y());
    return z;
  };
  const auto best_b = [&](double a) { return least(most, [&](double b) { return height(a, b); }); };
  const double a = least(most, [&](double x) { return height(x, best_b(x)); });
  return {a, best_b(a)};
}

}  // namespace

std::optional<Pose> pressing_pose(const model::HandModel& hand, const model::Shape& box,
                                  double above) {
  const std::vector<Vector3d> points = points_of(hand);
  const Vector3d half = model::half_extents(box);
  Pose X_OG =
      make_pose(Vector3d(0, 0, above), model::grasp_axes(-Vector3d::UnitX(), Vector3d::UnitY()));
  const auto before_box = [&] {
    std::vector<Vector3d> those;
    for (const Vector3d& point : points) {
      const Vector3d p_O = X_OG * point;
      if (std::abs(p_O.y()) < half.y() && std::abs(p_O.z()) < half.z()) those.push_back(point);
    }
    return those;
  };
  const std::vector<Vector3d> flat = before_box();
  if (flat.empty()) return std::nullopt;
  const Vector2d slopes = resting_slopes(flat);
  const Vector3d normal = X_OG.linear() * Vector3d(-slopes.x(), -slopes.y(), 1).normalized();
  X_OG.linear() = Eigen::Quaterniond::FromTwoVectors(normal, -Vector3d::UnitX()) * X_OG.linear();
  double foremost = std::numeric_limits<double>::infinity();  // x in O
  for (const Vector3d& point : before_box()) foremost = std::min(foremost, (X_OG * point).x());
  if (!std::isfinite(foremost)) return std::nullopt;  // turned, it passes by
  X_OG.pretranslate((half.x() - foremost) * Vector3d::UnitX());
  return X_OG;
}

}  // namespace prehend::cli
