#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/arm/collision.hpp"
#include "tests/support/planning/tables.hpp"

namespace prehend::test {

namespace {

using Eigen::Vector3d;

constexpr double grain = 0.008;  // m, between points of a surface

/// A solid with points all over its surface.
struct Grained {
  model::Shape shape;
  std::vector<Vector3d> points;
  double radius = 0;
};

Grained grained(const model::Shape& shape) {
  Grained made{shape, {}, model::half_extents(shape).norm()};
  const Vector3d half = model::half_extents(shape);
  const auto steps = [](double length) { return std::max(2, int(std::ceil(length / grain))); };
  const auto add = [&](double x, double y, double z) { made.points.emplace_back(x, y, z); };
  if (shape.kind == model::ShapeKind::box) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3, nu = steps(2 * half[u]),
                nv = steps(2 * half[v]);
      for (int i = 0; i <= nu; ++i)
        for (int j = 0; j <= nv; ++j)
          for (const double side : {-1.0, 1.0}) {
            Vector3d p;
            p[axis] = side * half[axis];
            p[u] = half[u] * (2.0 * i / nu - 1);
            p[v] = half[v] * (2.0 * j / nv - 1);
            made.points.push_back(p);
          }
    }
    return made;
  }
  const bool is_ball = shape.kind == model::ShapeKind::sphere;
  const int around = steps(2 * std::numbers::pi * half.x()), up = steps(2 * half.z()),
            in = steps(half.x());
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around;
    for (int k = 0; k <= up; ++k) {
      const double z = half.z() * (2.0 * k / up - 1);
      const double r = is_ball ? std::sqrt(std::max(0.0, half.z() * half.z() - z * z)) : half.x();
      add(r * std::cos(angle), r * std::sin(angle), z);
    }
    for (int k = 0; !is_ball && k < in; ++k)
      for (const double side : {-1.0, 1.0})
        add(half.x() * k / in * std::cos(angle), half.x() * k / in * std::sin(angle),
            side * half.z());
  }
  return made;
}

double gap(const Grained& a, const Pose& X_WA, const Grained& b, const Pose& X_WB, double most) {
  if ((X_WA.translation() - X_WB.translation()).norm() > a.radius + b.radius + most) return most;
  const Pose X_BA = X_WB.inverse() * X_WA, X_AB = X_BA.inverse();
  for (const Vector3d& p : a.points) most = std::min(most, signed_distance(b.shape, X_BA * p));
  for (const Vector3d& p : b.points) most = std::min(most, signed_distance(a.shape, X_AB * p));
  return most;
}

/// By points on the capsule's line.
double gap(const model::Capsule& capsule, const Pose& X_WL, const Grained& b, const Pose& X_WB,
           double most) {
  const Pose X_BL = X_WB.inverse() * X_WL;
  const int parts = std::max(1, int(std::ceil((capsule.b - capsule.a).norm() / 0.004)));
  for (int k = 0; k <= parts; ++k) {
    const Vector3d p = X_BL * Vector3d(capsule.a + double(k) / parts * (capsule.b - capsule.a));
    most = std::min(most, signed_distance(b.shape, p) - capsule.radius);
  }
  return most;
}

struct Things {
  std::vector<std::pair<Grained, Pose>> carried, fixed;  // in B, in W
};

Things things_of(const planning::Robot& robot, const planning::Scene& scene) {
  Things made;
  const model::HandModel& hand = *robot.hand;
  const auto X_BL = hand.link_poses(
      hand.joint_angles(scene.dof.size() > 0 ? scene.dof : hand.postures().at("open")));
  for (std::size_t i = 0; i < X_BL.size(); ++i)
    for (const auto& shape : hand.links()[i].collision)
      made.carried.emplace_back(grained(shape.shape), X_BL[i] * shape.X_LS);
  if (scene.held) made.carried.emplace_back(grained(scene.held->solid.shape), scene.held->X_BO);
  for (const auto& obstacle : scene.obstacles)
    made.fixed.emplace_back(grained(obstacle.solid.shape), obstacle.X_WO);
  return made;
}

double gap_at(const planning::Robot& robot, const planning::Scene& scene, const Things& things,
              const arm::Joints& q, double least) {
  const auto at = arm::forward(*robot.arm, q);
  const Pose X_WB = robot.hand_at(q);
  for (const auto& [solid, X_BO] : things.carried) {
    const Pose X = X_WB * X_BO;
    if (scene.table && X.translation().z() - solid.radius < least)
      for (const Vector3d& p : solid.points) least = std::min(least, (X * p).z());
    for (const auto& [other, X_WO] : things.fixed) least = gap(solid, X, other, X_WO, least);
  }
  for (std::size_t i = 1; i < robot.arm->links.size(); ++i)
    for (const model::Capsule& capsule : robot.arm->links[i].capsules)
      for (const auto& [other, X_WO] : things.fixed)
        least = gap(capsule, robot.X_WA * at.X_AL[i], other, X_WO, least);
  return least;
}

}  // namespace

double min_gap(const planning::Robot& robot, const planning::Scene& scene,
               const planning::Trajectory& trajectory, double step) {
  const Things things = things_of(robot, scene);
  const arm::Joints lever = arm::levers(*robot.arm, {{Vector3d(0, 0, 0.35), {0, 0, 0.35}, 0}});
  double least = 1;
  arm::Joints last = trajectory.at(0);
  least = gap_at(robot, scene, things, last, least);
  for (double t = 0; t < trajectory.duration();) {
    t += 0.002;
    const arm::Joints q = trajectory.at(t);
    if ((q - last).cwiseAbs().dot(lever) < step && t < trajectory.duration()) continue;
    least = gap_at(robot, scene, things, q, least);
    last = q;
  }
  return least;
}

}  // namespace prehend::test
