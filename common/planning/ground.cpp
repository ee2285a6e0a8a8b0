#include "common/planning/ground.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace prehend::planning {
namespace {

using arm::Joints;
using Eigen::Vector3d;

constexpr double stride = 0.25, upright_stride = 0.04;  // m, between postures of a path
constexpr double progress = 0.2;                        // of a stride, or it is stuck
constexpr double straight = 0.02;                       // rad, of a hand that was straightened

}  // namespace

double Ground::length(const Path& path) const {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += length(path[i - 1], path[i]);
  return sum;
}

double Ground::tilt(const Joints& q) const {
  if (!upright_) return 0;
  const Vector3d up = robot_.hand_at(q).linear() * upright_->up_B;
  return std::atan2(up.head<2>().norm(), up.z());
}

/// Turns the joints, by as little as may be, until the hand is upright again.
bool Ground::straighten(Joints& q) const {
  for (int n = 0; n < 5; ++n) {
    const arm::Configuration at = arm::forward(*robot_.arm, q);
    const Eigen::Matrix3d R_WA = robot_.X_WA.linear();
    const Vector3d up = R_WA * (at.X_AE * robot_.X_EB).linear() * upright_->up_B;
    const Eigen::Vector2d turn = up.cross(Vector3d::UnitZ()).head<2>();
    if (turn.norm() < straight && up.z() > 0) return true;
    const Eigen::Matrix<double, 2, Eigen::Dynamic> J =
        (R_WA * arm::jacobian(*robot_.arm, at).bottomRows<3>()).topRows<2>();
    const Eigen::Matrix2d squares = J * J.transpose() + 1e-6 * Eigen::Matrix2d::Identity();
    q += J.transpose() * (squares.inverse() * turn);
  }
  return false;
}

bool Ground::is_free(const Joints& from, const Joints& to) const {
  return tilt(to) <= max_tilt() && room_.is_free(from, to);
}

Path Ground::walk(const Joints& from, const Joints& to, double longest) const {
  const double pace = upright_ ? upright_stride : stride;
  Path path;
  Joints at = from;
  for (double gone = 0; gone < longest;) {
    const double left = length(at, to);
    if (left == 0) break;
    const double parts = std::ceil(left / pace);
    Joints next = parts <= 1 ? to : Joints(at + (to - at) / parts);
    if (upright_ && parts > 1 &&
        (!straighten(next) || length(next, to) > left - progress * left / parts))
      break;
    if (!is_free(at, next)) break;
    gone += length(at, next);
    path.push_back(next);
    at = next;
  }
  return path;
}

std::optional<Path> Ground::way(const Joints& from, const Joints& to) const {
  Path path = walk(from, to, 1e9);
  if (path.empty() || path.back() != to) return std::nullopt;
  return path;
}

}  // namespace prehend::planning
