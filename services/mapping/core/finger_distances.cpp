#include "services/mapping/core/finger_distances.hpp"

#include <cmath>
#include <limits>

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr double spacing = 0.008;  // m, at most

/// -half .. half in equal steps of at most `spacing`.
std::vector<double> steps(double half) {
  const int count = std::max(1, static_cast<int>(std::ceil(2 * half / spacing)));
  std::vector<double> places;
  for (int i = 0; i <= count; ++i) places.push_back(half * (2.0 * i / count - 1));
  return places;
}

}  // namespace

FingerDistances::FingerDistances(const model::HandModel& hand) : hand_(hand) {
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    const model::HandLink& link = hand.links()[i];
    if (link.finger < 0 || link.collision.empty()) continue;
    Link made{static_cast<int>(i), link.finger, {}};
    for (const model::CollisionShape& part : link.collision) {
      const Vector3d half = half_extents(part.shape);
      if (part.shape.kind == model::ShapeKind::sphere) {
        made.balls.push_back({part.X_LS.translation(), half.x()});
      } else if (part.shape.kind == model::ShapeKind::cylinder) {
        // A capsule that is a little longer than the cylinder, since its ends are round.
        const double axis = std::max(0.0, half.z() - 0.7 * half.x());
        for (const double z : steps(axis))
          made.balls.push_back({part.X_LS * Vector3d(0, 0, z), std::min(half.x(), half.z())});
      } else {
        int along = 0;
        half.maxCoeff(&along);
        const int u = (along + 1) % 3, v = (along + 2) % 3;
        for (const double a : steps(half[along]))
          for (const double b : {-1, 0, 1})
            for (const double c : {-1, 0, 1}) {
              if (b == 0 && c == 0) continue;
              Vector3d p;
              p[along] = a;
              p[u] = b * half[u];
              p[v] = c * half[v];
              made.balls.push_back({part.X_LS * p, 0});
            }
      }
    }
    links_.push_back(std::move(made));
  }
  for (const model::HandDof& dof : hand.dofs()) {
    const int link = hand.joints()[static_cast<std::size_t>(dof.joint)].child;
    finger_of_.push_back(hand.links()[static_cast<std::size_t>(link)].finger);
  }
}

Eigen::VectorXd FingerDistances::distances(const Eigen::VectorXd& dof, const model::Shape& shape,
                                           const Pose& X_BO) const {
  Eigen::VectorXd least =
      Eigen::VectorXd::Constant(fingers(), std::numeric_limits<double>::infinity());
  const std::vector<Pose> X_BL = hand_.link_poses(hand_.joint_angles(dof));
  const Pose X_OB = X_BO.inverse();
  for (const Link& link : links_) {
    const Pose X_OL = X_OB * X_BL[static_cast<std::size_t>(link.link)];
    double& nearest = least[link.finger];
    for (const Ball& ball : link.balls)
      nearest = std::min(nearest, signed_distance(shape, X_OL * ball.p_L) - ball.radius);
  }
  return least;
}

}  // namespace prehend::mapping
