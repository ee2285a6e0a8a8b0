#include "services/planner/tools/hand_import/skeleton.hpp"

#include <algorithm>
#include <map>

#include "services/planner/tools/hand_import/contact_world.hpp"
#include "services/planner/tools/hand_import/overlap.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double same_reach = 0.8;   // share of the farthest leaf of the same DoFs
constexpr double tip_slice = 0.002;  // m: the end of a link, whose middle is the tip
constexpr double min_tip = 0.005;

/// Points on all shapes of a link, in its frame; its origin if it has none.
std::vector<Vector3d> points_of(const model::HandLink& link) {
  std::vector<Vector3d> points;
  for (const model::CollisionShape& part : link.collision)
    for (const Vector3d& p_S : surface_points(part.shape)) points.push_back(part.X_LS * p_S);
  if (points.empty()) points.push_back(Vector3d::Zero());
  return points;
}

Vector3d middle_of(const std::vector<Vector3d>& points) {
  Vector3d low = points[0], high = points[0];
  for (const Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return 0.5 * (low + high);
}

}  // namespace

Skeleton::Skeleton(const model::HandModel& hand) : hand_(hand), rest_(hand.postures().at("open")) {
  find_palm();
  find_fingers();
}

const model::HandJoint& Skeleton::joint(int i) const {
  return hand_.joints()[at(i)];
}

std::vector<Pose> Skeleton::poses(const VectorXd& dof) const {
  return hand_.link_poses(hand_.joint_angles(dof));
}

std::vector<Vector3d> Skeleton::tips(const VectorXd& dof) const {
  const auto X_BL = poses(dof);
  std::vector<Vector3d> p_BT;
  for (const FingerChain& finger : fingers_) p_BT.push_back(X_BL[at(finger.leaf)] * finger.p_LT);
  return p_BT;
}

// The link on which the hand branches, and the joints before it: a wrist.
void Skeleton::find_palm() {
  while (true) {
    std::vector<int> next;
    for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i)
      if (joint(i).parent == palm_) next.push_back(i);
    if (next.size() != 1) break;
    wrist_.push_back(next[0]);
    palm_ = joint(next[0]).child;
  }
  // A single chain is a finger, not a wrist.
  if (std::none_of(hand_.joints().begin(), hand_.joints().end(),
                   [&](const auto& j) { return j.parent == palm_; })) {
    palm_ = 0;
    wrist_.clear();
  }
  p_BP_ = poses(rest_)[at(palm_)] * middle_of(points_of(hand_.links()[at(palm_)]));
}

std::vector<Vector3d> Skeleton::palm_points() const {
  std::vector<Vector3d> points = points_of(hand_.links()[at(palm_)]);
  const Pose X_BP = poses(rest_)[at(palm_)];
  for (Vector3d& p : points) p = X_BP * p;
  return points;
}

bool Skeleton::is_wrist(int dof) const {
  bool moves_palm = false, moves_more = false;
  for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i) {
    if (joint(i).dof != dof) continue;
    const bool before = std::find(wrist_.begin(), wrist_.end(), i) != wrist_.end();
    (before ? moves_palm : moves_more) = true;
  }
  return moves_palm && !moves_more;
}

void Skeleton::find_fingers() {
  std::vector<bool> carries(hand_.links().size(), false);
  for (const auto& j : hand_.joints()) carries[at(j.parent)] = true;
  for (int link = 1; link < static_cast<int>(carries.size()); ++link) {
    if (carries[at(link)]) continue;
    FingerChain finger;
    finger.leaf = link;
    for (int l = link; l != palm_ && l > 0; l = joint(hand_.links()[at(l)].joint).parent) {
      finger.joints.insert(finger.joints.begin(), hand_.links()[at(l)].joint);
      finger.dofs.insert(joint(finger.joints.front()).dof);
    }
    if (finger.joints.empty()) continue;
    finger.p_LT = end_of(finger);
    const auto X_BL = poses(rest_);
    const model::HandJoint& first = joint(finger.joints.front());
    finger.reach = (X_BL[at(link)] * finger.p_LT - X_BL[at(first.child)].translation()).norm() +
                   (first.kind == model::JointKind::prismatic ? 1.0 : 0.0);
    fingers_.push_back(finger);
  }
  std::map<std::set<int>, double> farthest;
  for (const FingerChain& f : fingers_) farthest[f.dofs] = std::max(farthest[f.dofs], f.reach);
  std::erase_if(fingers_,
                [&](const FingerChain& f) { return f.reach < same_reach * farthest[f.dofs]; });
}

// The end of the last link: from its joint towards the middle of its shapes, and for a sliding
// link across the slide.
Vector3d Skeleton::end_of(const FingerChain& finger) const {
  const auto points = points_of(hand_.links()[at(finger.leaf)]);
  const model::HandJoint& last = joint(finger.joints.back());
  Vector3d bone = middle_of(points);
  if (last.kind == model::JointKind::prismatic) {
    bone -= bone.dot(last.axis_J) * last.axis_J;
    // The finger may start beside the palm: it points away from it all the same.
    const Vector3d p_LP = poses(rest_)[at(finger.leaf)].inverse() * p_BP_;
    Vector3d away = middle_of(points) - p_LP;
    away -= away.dot(last.axis_J) * last.axis_J;
    if (away.norm() > min_tip) bone = away;
  } else if (bone.norm() < min_tip && finger.joints.size() > 1) {
    bone = last.X_PJ.linear().transpose() * last.X_PJ.translation();
  }
  if (bone.norm() < 1e-9) return middle_of(points);
  bone.normalize();
  double extent = -1e9;
  for (const Vector3d& p : points) extent = std::max(extent, bone.dot(p));
  std::vector<Vector3d> end;
  for (const Vector3d& p : points)
    if (bone.dot(p) > extent - tip_slice) end.push_back(p);
  const Vector3d tip = middle_of(end);
  return tip + (extent - bone.dot(tip)) * bone;
}

Vector3d Skeleton::axis(int i) const {
  const model::HandJoint& j = joint(i);
  return (j.multiplier < 0 ? -1.0 : 1.0) * (poses(rest_)[at(j.child)].linear() * j.axis_J);
}

}  // namespace prehend::planner
