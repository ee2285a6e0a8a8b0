#include "services/cli/tools/demo/first_touch.hpp"

#include <limits>
#include <numbers>

namespace prehend::cli {
namespace {

using Eigen::Vector3d;

/// Points all over the surface of a solid, in its frame O.
std::vector<Vector3d> points_of(const model::Shape& shape) {
  constexpr int turns = 48, rings = 25;
  const Vector3d half = model::half_extents(shape);
  std::vector<Vector3d> points;
  for (int ring = 0; ring < rings; ++ring) {
    const double share = -1 + 2.0 * ring / (rings - 1);  // of the height
    for (int turn = 0; turn < turns; ++turn) {
      const double angle = 2 * std::numbers::pi * turn / turns;
      const Vector3d round(std::cos(angle), std::sin(angle), 0);
      if (shape.kind == model::ShapeKind::sphere)
        points.push_back(half.x() *
                         (std::sqrt(1 - share * share) * round + share * Vector3d::UnitZ()));
      else if (shape.kind == model::ShapeKind::box)  // round a square
        points.push_back(
            half.cwiseProduct(round / round.cwiseAbs().maxCoeff() + share * Vector3d::UnitZ()));
      else
        points.push_back(model::radius_at(shape, share * half.z()) * round +
                         share * half.z() * Vector3d::UnitZ());
    }
  }
  return points;
}

}  // namespace

double first_touch(const model::HandModel& hand, const model::Shape& box, double above) {
  const Pose X_OG =
      make_pose(Vector3d(0, 0, above), model::grasp_axes(-Vector3d::UnitX(), Vector3d::UnitY()));
  const Pose X_OB = X_OG * hand.X_BG().inverse();
  const auto X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  const Vector3d half = model::half_extents(box);
  double foremost = std::numeric_limits<double>::infinity();  // x in O
  for (std::size_t link = 0; link < X_BL.size(); ++link)
    for (const model::CollisionShape& part : hand.links()[link].collision)
      for (const Vector3d& point : points_of(part.shape)) {
        const Vector3d p_O = X_OB * X_BL[link] * part.X_LS * point;
        if (std::abs(p_O.y()) < half.y() && std::abs(p_O.z()) < half.z())
          foremost = std::min(foremost, p_O.x());
      }
  return foremost;
}

}  // namespace prehend::cli
