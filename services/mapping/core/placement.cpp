#include "services/mapping/core/placement.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::mapping {

Pose toward(const Pose& X_WG, const Pose& X_WG_grasp, double max_distance, double max_angle) {
  Eigen::Vector3d off = X_WG_grasp.inverse() * X_WG.translation();
  const double beside = off.head<2>().norm(), before = std::abs(off.z());
  const double sideways = std::min(beside, max_distance);
  const double left = std::sqrt(max_distance * max_distance - sideways * sideways);
  const double along = before <= left ? before : std::max(0.0, 2 * left - before);
  if (beside > 0) off.head<2>() *= 1 - sideways / beside;
  if (before > 0) off.z() *= 1 - along / before;
  const Pose moved = make_pose(X_WG_grasp * off, X_WG_grasp.linear());
  return limit_step(X_WG, moved, max_distance, max_angle);
}

double yielding(const Eigen::ArrayXd& before, const Eigen::ArrayXd& after, double step,
                double room) {
  constexpr double far = 1;  // m
  double rising = far, falling = far;
  for (Eigen::Index f = 0; f < before.size(); ++f) {
    // Fingers that are not beside the object do not push it sideways.
    const double slope = (after[f] - before[f]) / (2 * step);
    double& nearest = slope > 0 ? rising : falling;
    if (std::abs(slope) > 0.5) nearest = std::min(nearest, 0.5 * (after[f] + before[f]));
  }
  if (falling < room && rising > room) return -std::min(room - falling, rising - room);
  if (rising < room && falling > room) return std::min(room - rising, falling - room);
  return 0;
}

void Placement::start(const Pose& X_WG, const Pose& X_WB) {
  correction_ = limit_step(Pose::Identity(), X_WG.inverse() * X_WB * hand_.X_BG(),
                           options_.max_distance, options_.max_angle);
}

void Placement::release() {
  full_correction_ = Pose::Identity();
  yielded_ = 0;
}

/// Where the hand's grasp frame should stand.
Pose Placement::place_of(const GraspTarget& target) const {
  return target.X_WG * Eigen::Translation3d(0, yielded_, 0) * target.X_GR;
}

void Placement::yield(const GraspTarget& target, const Detection& object,
                      const FingerDistances& fingers, const Eigen::VectorXd& dof) {
  const Pose X_OG = object.X_WO.inverse() * place_of(target);
  const auto distances = [&](double y) -> Eigen::ArrayXd {
    const Pose X_OG_moved = X_OG * Eigen::Translation3d(0, y, 0);
    return fingers.distances(dof, object.shape, hand_.X_BG() * X_OG_moved.inverse());
  };
  constexpr double step = 0.002;  // m
  const double by = yielding(distances(-step), distances(step), step, options_.yield);
  yielded_ = std::clamp(yielded_ + by, -options_.max_distance, options_.max_distance);
}

void Placement::aim(const Pose& X_WG, const GraspTarget& target) {
  full_correction_ =
      X_WG.inverse() * toward(X_WG, place_of(target), options_.max_distance, options_.max_angle);
}

void Placement::follow(double weight, Duration elapsed) {
  const double t = to_seconds(elapsed);
  const Pose wanted = interpolate(Pose::Identity(), full_correction_, weight);
  correction_ = limit_step(correction_, wanted, options_.speed * t, options_.turn_speed * t);
}

Pose Placement::X_WB(const Pose& X_WG) const {
  return X_WG * correction_ * hand_.X_BG().inverse();
}

Pose Placement::X_WG(const Pose& X_WB) const {
  return X_WB * hand_.X_BG() * correction_.inverse();
}

}  // namespace prehend::mapping
