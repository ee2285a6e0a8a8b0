#include "services/mapping/core/capsules.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

constexpr int max_rows = 6;  // capsules beside each other

/// Of a part that is no finger's: boxes, as palms are, by capsules side by side.
std::vector<Capsule> capsules_of(const model::Shape& shape) {
  if (shape.kind != model::ShapeKind::box) return {finger_capsule(shape)};
  const Vector3d half = half_extents(shape);
  std::array<int, 3> axes{0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int k) { return half[i] > half[k]; });
  const auto [along, across, thin] = axes;
  const double radius = half[thin];
  if (radius <= 0) return {finger_capsule(shape)};
  const double aside = half[across] - radius;
  const int rows = std::min(max_rows, 1 + static_cast<int>(std::ceil(aside / radius)));
  std::vector<Capsule> made;
  for (int row = 0; row < rows; ++row) {
    Vector3d middle = Vector3d::Zero(), end = Vector3d::Zero();
    if (rows > 1) middle[across] = aside * (2.0 * row / (rows - 1) - 1);
    end[along] = half[along] - radius;
    made.push_back({middle - end, middle + end, radius});
  }
  return made;
}

}  // namespace

double nearest(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d along = b - a;
  const double length = along.squaredNorm();
  return length > 0 ? std::clamp(along.dot(p - a) / length, 0.0, 1.0) : 0.0;
}

/// The nearest points of the endless lines, or else one of them is an end.
Vector3d between_lines(const Capsule& one, const Capsule& other) {
  const Vector3d u = one.b - one.a, v = other.b - other.a, w = one.a - other.a;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  double s = 0;
  if (determinant > 1e-12 * uu * vv)
    s = std::clamp((uv * v.dot(w) - vv * u.dot(w)) / determinant, 0.0, 1.0);
  const double t = nearest(other.a, other.b, one.a + s * u);
  s = nearest(one.a, one.b, other.a + t * v);
  return one.a + s * u - other.a - t * v;
}

double distance(const Capsule& one, const Capsule& other) {
  return between_lines(one, other).norm() - one.radius - other.radius;
}

Capsule finger_capsule(const model::Shape& shape) {
  const Vector3d half = half_extents(shape);
  int along = 2;
  if (shape.kind == model::ShapeKind::box) half.maxCoeff(&along);
  Vector3d end = Vector3d::Zero();
  const double radius = 0.5 * (half.sum() - half[along]);
  // Cylinders of a finger have round ends, or are as squat as a ball; a box is flat there.
  if (shape.kind == model::ShapeKind::cylinder && half[along] > radius) end[along] = half[along];
  if (shape.kind == model::ShapeKind::box) end[along] = std::max(0.0, half[along] - 0.5 * radius);
  return {-end, end, radius};
}

HandCapsules::HandCapsules(const model::HandModel& hand) : hand_(hand) {
  for (std::size_t i = 0; i < hand.links().size(); ++i)
    for (const model::CollisionShape& part : hand.links()[i].collision) {
      const auto those = hand.links()[i].finger < 0 ? capsules_of(part.shape)
                                                    : std::vector{finger_capsule(part.shape)};
      for (const Capsule& one : those)
        parts_.push_back({i, {part.X_LS * one.a, part.X_LS * one.b, one.radius}});
    }
  // Of each link's origin, if all joints before it stretched out.
  std::vector<double> away(hand.links().size());
  for (const model::HandJoint& joint : hand.joints()) {
    const double slid = joint.kind == model::JointKind::prismatic
                            ? std::max(std::abs(joint.lower), std::abs(joint.upper))
                            : 0;
    away[static_cast<std::size_t>(joint.child)] =
        away[static_cast<std::size_t>(joint.parent)] + joint.X_PJ.translation().norm() + slid;
  }
  for (const auto& [link, capsule] : parts_)
    reach_ = std::max(reach_,
                      away[link] + capsule.radius + std::max(capsule.a.norm(), capsule.b.norm()));
}

std::vector<Capsule> HandCapsules::at(const Pose& X_WB, const Eigen::VectorXd& dof) const {
  const auto X_BL = hand_.link_poses(hand_.joint_angles(dof));
  std::vector<Capsule> placed;
  placed.reserve(parts_.size());
  for (const auto& [link, capsule] : parts_) {
    const Pose X_WL = X_WB * X_BL[link];
    placed.push_back({X_WL * capsule.a, X_WL * capsule.b, capsule.radius});
  }
  return placed;
}

}  // namespace prehend::mapping
