#include "services/planner/tools/hand_import/contact_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "services/planner/tools/hand_import/overlap.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double touching = 0.0015;  // m
constexpr double stride = 0.05;      // share of a DoF's range, of a step of closing, at most
constexpr double friction = 0.6;     // less than that of rubber: contacts of boxes are not exact
constexpr int min_balls = 5;         // along a rod, and no gaps between them

/// The point of a shape that is nearest to p; p itself inside.
Vector3d nearest_point(const model::Shape& shape, const Vector3d& p) {
  const Vector3d half = model::half_extents(shape);
  if (shape.kind == model::ShapeKind::box) return p.cwiseMax(-half).cwiseMin(half);
  if (shape.kind == model::ShapeKind::sphere)
    return p.norm() > half.x() ? Vector3d(half.x() * p.normalized()) : p;
  Vector3d q(p.x(), p.y(), 0);
  if (q.norm() > half.x()) q *= half.x() / q.norm();
  q.z() = std::clamp(p.z(), -half.z(), half.z());
  return q;
}

}  // namespace

ContactWorld::ContactWorld(const model::HandModel& hand, std::vector<int> closing,
                           const std::vector<int>& fingers)
    : hand_(hand),
      closing_(std::move(closing)),
      finger_(hand.links().size(), -2),
      last_(hand.links().size(), false),
      moved_by_(hand.links().size()) {
  for (int f = 0; f < static_cast<int>(fingers.size()); ++f) {
    last_[at(fingers[at(f)])] = true;
    for (int link = fingers[at(f)]; link > 0;
         link = hand.joints()[at(hand.links()[at(link)].joint)].parent)
      finger_[at(link)] = finger_[at(link)] == -2 ? f : -1;
  }
  for (int link = 0; link < static_cast<int>(finger_.size()); ++link) {
    for (int l = link; l > 0;) {
      const model::HandJoint& joint = hand.joints()[at(hand.links()[at(l)].joint)];
      if (closing_[at(joint.dof)] != 0) moved_by_[at(link)].push_back(joint.dof);
      l = joint.parent;
    }
    // A branch without a tip of its own goes with what carries it.
    if (finger_[at(link)] == -2)
      finger_[at(link)] =
          link == 0 ? -1 : finger_[at(hand.joints()[at(hand.links()[at(link)].joint)].parent)];
    for (const model::CollisionShape& part : hand.links()[at(link)].collision)
      parts_.push_back({link, part.shape, part.X_LS, model::half_extents(part.shape).norm()});
  }
}

ContactWorld::Nearest ContactWorld::nearest(const Part& part, const std::vector<Pose>& X_BL,
                                            const Rod& rod, double most) const {
  Nearest found{most, Vector3d::Zero()};
  const Pose X_BS = X_BL[at(part.link)] * part.X_LS;
  const Vector3d along = rod.X_BR.linear().col(0);
  const int balls =
      std::max(min_balls, static_cast<int>(std::ceil(rod.half_length / rod.radius)) + 1);
  for (int i = 0; i < balls; ++i) {
    const Vector3d p_B =
        rod.X_BR.translation() + (2.0 * i / (balls - 1) - 1) * rod.half_length * along;
    const Vector3d from = p_B - X_BS.translation();
    if (from.norm() - part.radius - rod.radius > found.distance) continue;
    const Vector3d p_S = X_BS.linear().transpose() * from;
    const Vector3d towards = nearest_point(part.shape, p_S) - p_S;
    const double distance = towards.norm() - rod.radius;
    if (distance >= found.distance) continue;
    found.distance = distance;
    found.normal_R = rod.X_BR.linear().transpose() * (X_BS.linear() * towards);
  }
  found.normal_R.x() = 0;
  if (found.normal_R.norm() > 1e-9) found.normal_R.normalize();
  return found;
}

double ContactWorld::room(const VectorXd& dof, const Rod& rod, double most) const {
  const auto X_BL = hand_.link_poses(hand_.joint_angles(dof));
  for (const Part& part : parts_) most = nearest(part, X_BL, rod, most).distance;
  return most;
}

std::vector<Touch> ContactWorld::close(VectorXd dof, const Rod& rod) const {
  const auto count = static_cast<std::size_t>(dof.size());
  std::vector<bool> stopped(count);
  for (std::size_t i = 0; i < count; ++i) stopped[i] = closing_[i] == 0;
  std::vector<bool> at_end(count, false);
  std::vector<Touch> touches;
  for (int step = 0; step < 200; ++step) {
    const auto X_BL = hand_.link_poses(hand_.joint_angles(dof));
    double least = 1e9;  // of what still moves
    touches.clear();
    for (const Part& part : parts_) {
      const Nearest found = nearest(part, X_BL, rod, 0.05);
      const auto& moved_by = moved_by_[at(part.link)];
      if (found.distance < touching) {
        const bool presses = moved_by.empty() || std::any_of(moved_by.begin(), moved_by.end(),
                                                             [&](int d) { return !at_end[at(d)]; });
        touches.push_back(
            {part.link, finger_[at(part.link)], last_[at(part.link)], presses, found.normal_R});
        for (const int d : moved_by) stopped[at(d)] = true;
      } else {
        for (const int d : moved_by)
          if (!stopped[at(d)]) least = std::min(least, found.distance);
      }
    }
    bool moves = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (stopped[i]) continue;
      const model::HandDof& d = hand_.dofs()[i];
      const double range = d.upper - d.lower;
      // No link is longer than 0.2 m from the joint that turns it; three joints may add up.
      const double safe = d.kind == model::JointKind::prismatic ? 0.5 * least : least / 0.4;
      const double end = closing_[i] > 0 ? d.upper : d.lower;
      const double by = std::clamp(safe, 0.002 * range, stride * range);
      double& value = dof[static_cast<Eigen::Index>(i)];
      value = closing_[i] > 0 ? std::min(value + by, end) : std::max(value - by, end);
      if (value == end) stopped[i] = at_end[i] = true;
      moves = true;
    }
    if (!moves) break;
  }
  return touches;
}

double ContactWorld::overlap_of_fingers(const VectorXd& dof, double least) const {
  const auto X_BL = hand_.link_poses(hand_.joint_angles(dof));
  double deepest = least;
  // No nearer than from the middle of one, with the ball around it.
  const auto apart = [](const Part& part, const Pose& X_BS, const Part& from, const Pose& X_BT) {
    return model::signed_distance(part.shape, X_BS.inverse() * X_BT.translation()) - from.radius;
  };
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for (std::size_t k = i + 1; k < parts_.size(); ++k) {
      const Part &one = parts_[i], &other = parts_[k];
      const int finger = finger_[at(one.link)], another = finger_[at(other.link)];
      if (finger < 0 || another < 0 || finger == another) continue;
      const Pose X_BS = X_BL[at(one.link)] * one.X_LS, X_BT = X_BL[at(other.link)] * other.X_LS;
      if (-apart(one, X_BS, other, X_BT) > deepest && -apart(other, X_BT, one, X_BS) > deepest)
        deepest = std::max(deepest, overlap(one.shape, X_BS, other.shape, X_BT));
    }
  return deepest;
}

Vector3d ContactWorld::nearest_of_palm(const VectorXd& dof, const Vector3d& p_B) const {
  const auto X_BL = hand_.link_poses(hand_.joint_angles(dof));
  Vector3d best = Vector3d::Zero();
  double least = 1e9;
  for (const Part& part : parts_) {
    if (finger_[at(part.link)] >= 0) continue;
    const Pose X_BS = X_BL[at(part.link)] * part.X_LS;
    const Vector3d q = X_BS * nearest_point(part.shape, X_BS.inverse() * p_B);
    if ((q - p_B).norm() >= least) continue;
    least = (q - p_B).norm();
    best = q;
  }
  return best;
}

double grip_quality(const std::vector<Touch>& touches) {
  std::set<int> fingers;
  for (const Touch& touch : touches)
    if (touch.presses) fingers.insert(touch.finger);
  if (fingers.size() < 2) return 0;
  constexpr int directions = 16;
  double least = 1e9;
  for (int i = 0; i < directions; ++i) {
    const double angle = 2 * std::numbers::pi * i / directions;
    const Vector3d d(0, std::cos(angle), std::sin(angle));
    double most = -1e9;
    for (const Touch& touch : touches) {
      if (!touch.presses) continue;
      const Vector3d& n = touch.normal_R;
      const Vector3d tangent(0, -n.z(), n.y());
      most = std::max(most, -n.dot(d) + friction * std::abs(tangent.dot(d)));
    }
    least = std::min(least, most);
  }
  return least;
}

}  // namespace prehend::planner
