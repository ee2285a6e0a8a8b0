#include "services/mapping/core/finger_collision_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prehend::mapping {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double step = 0.008;      // m, that a finger moves between two looks
constexpr int max_steps = 32;       // of one command
constexpr double rounding = 1e-6;   // m
constexpr double part_of = 0.0025;  // m, by which a piece may stick out of one that stands for it

double length(const Capsule& capsule) {
  return (capsule.b - capsule.a).norm();
}

/// The fingers that a DoF moves, a bit each.
unsigned fingers_of(const model::HandModel& hand, std::size_t dof) {
  unsigned fingers = 0;
  for (const model::HandJoint& joint : hand.joints()) {
    const int finger = hand.links()[static_cast<std::size_t>(joint.child)].finger;
    if (joint.dof == static_cast<int>(dof) && finger >= 0) fingers |= 1U << finger;
  }
  return fingers;
}

}  // namespace

FingerCollisionLimiter::FingerCollisionLimiter(const model::HandModel& hand) : hand_(hand) {
  for (std::size_t i = 0; i < hand.links().size(); ++i) {
    const model::HandLink& link = hand.links()[i];
    if (link.finger < 0) continue;
    std::vector<Piece> made;
    for (const model::CollisionShape& part : link.collision) {
      const Capsule it = finger_capsule(part.shape);
      made.push_back(
          {static_cast<int>(i), link.finger, {part.X_LS * it.a, part.X_LS * it.b, it.radius}});
    }
    // The longest first; what lies within one that is there already adds nothing.
    std::stable_sort(made.begin(), made.end(), [](const Piece& one, const Piece& other) {
      return length(one.capsule_L) > length(other.capsule_L);
    });
    const auto first = static_cast<std::ptrdiff_t>(pieces_.size());
    for (const Piece& piece : made) {
      const auto within = [&](const Piece& other) {
        const Capsule &known = other.capsule_L, &it = piece.capsule_L;
        const auto inside = [&](const Vector3d& p) {
          const double s = nearest(known.a, known.b, p);
          const double off = (known.a + s * (known.b - known.a) - p).norm();
          return off + it.radius <= known.radius + part_of;
        };
        return inside(it.a) && inside(it.b);
      };
      if (std::none_of(pieces_.begin() + first, pieces_.end(), within)) pieces_.push_back(piece);
    }
  }
  const auto open = place(hand.postures().at("open")).placed;
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    for (std::size_t k = i + 1; k < pieces_.size(); ++k)
      if (pieces_[i].finger != pieces_[k].finger && distance({i, k}, open) > 0)
        pairs_.push_back({i, k});
  for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
    const unsigned fingers = fingers_of(hand, i);
    const auto known = std::find_if(groups_.begin(), groups_.end(),
                                    [&](const Group& group) { return group.fingers == fingers; });
    if (known == groups_.end())
      groups_.push_back({fingers, {static_cast<Index>(i)}, {}, {}});
    else
      known->dofs.push_back(static_cast<Index>(i));
  }
  for (Group& group : groups_) {
    for (std::size_t j = 0; j < hand.joints().size(); ++j) {
      const int finger = hand.links()[static_cast<std::size_t>(hand.joints()[j].child)].finger;
      if (finger >= 0 && (group.fingers >> finger & 1U)) group.joints.push_back(j);
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (group.fingers >> pieces_[i].finger & 1U) group.pieces.push_back(i);
  }
}

FingerCollisionLimiter::Placed FingerCollisionLimiter::place(const VectorXd& dof) const {
  Placed placed{dof, hand_.link_poses(hand_.joint_angles(dof)), {}};
  placed.placed.reserve(pieces_.size());
  for (const Piece& piece : pieces_) placed.placed.push_back(placed_at(piece, placed));
  return placed;
}

/// Puts the group's links where its DoFs are now; the others are there already.
void FingerCollisionLimiter::move(Placed& hand, const Group& group) const {
  for (const std::size_t j : group.joints) {
    const model::HandJoint& joint = hand_.joints()[j];
    const double q = joint.multiplier * hand.dof[joint.dof] + joint.offset;
    Pose& X_BC = hand.X_BL[static_cast<std::size_t>(joint.child)];
    X_BC = hand.X_BL[static_cast<std::size_t>(joint.parent)] * joint.X_PJ;
    if (joint.kind == model::JointKind::revolute)
      X_BC.rotate(Eigen::AngleAxisd(q, joint.axis_J));
    else
      X_BC.translate(q * joint.axis_J);
  }
  for (const std::size_t i : group.pieces) hand.placed[i] = placed_at(pieces_[i], hand);
}

Capsule FingerCollisionLimiter::placed_at(const Piece& piece, const Placed& hand) {
  const Pose& X_BL = hand.X_BL[static_cast<std::size_t>(piece.link)];
  return {X_BL * piece.capsule_L.a, X_BL * piece.capsule_L.b, piece.capsule_L.radius};
}

double FingerCollisionLimiter::distance(const Pair& pair, const std::vector<Capsule>& placed) {
  return mapping::distance(placed[pair.one], placed[pair.other]);
}

bool FingerCollisionLimiter::moves(const Group& group, const Pair& pair) const {
  return (group.fingers >> pieces_[pair.one].finger | group.fingers >> pieces_[pair.other].finger) &
         1U;
}

double FingerCollisionLimiter::clearance(const VectorXd& dof) const {
  const auto placed = place(dof).placed;
  double least = std::numeric_limits<double>::infinity();
  for (const Pair& pair : pairs_) least = std::min(least, distance(pair, placed));
  return least;
}

VectorXd FingerCollisionLimiter::go(const VectorXd& before, const VectorXd& after) const {
  Placed begin = place(before);
  const auto end = place(after).placed;
  std::vector<double> moved(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    moved[i] =
        std::max((end[i].a - begin.placed[i].a).norm(), (end[i].b - begin.placed[i].b).norm());

  // Pairs that can meet on the way. Most cannot, as the balls around them say.
  std::vector<Approach> close;
  bool free = true;
  for (const Pair& pair : pairs_) {
    const Capsule &one = end[pair.one], &other = end[pair.other];
    const double way = moved[pair.one] + moved[pair.other];
    const double thick = one.radius + other.radius;
    const double reach = way + thick + 0.5 * (length(one) + length(other));
    if (0.25 * (one.a + one.b - other.a - other.b).squaredNorm() > reach * reach) continue;
    const double then = distance(pair, end);
    if (then > way) continue;
    close.push_back({pair, distance(pair, begin.placed)});
    // A way as short as they are thick does not lead through each other.
    free = free && way < thick && then >= std::min(close.back().distance, 0.0) - rounding;
  }
  if (free) return after;

  // Groups that none of these belong to just go.
  VectorXd reached = after;
  std::vector<Careful> careful;
  for (const Group& group : groups_) {
    Careful one{&group, {}};
    for (std::size_t i = 0; i < close.size(); ++i)
      if (moves(group, close[i].pair)) one.approaches.push_back(i);
    if (!one.approaches.empty()) careful.push_back(std::move(one));
  }
  const double farthest = *std::max_element(moved.begin(), moved.end());
  const int steps = std::clamp(static_cast<int>(std::ceil(farthest / step)), 1, max_steps);
  const VectorXd change = (after - before) / steps;
  for (int i = 0; i < steps && creep(begin, careful, change, close); ++i) {
  }
  for (const Careful& one : careful)
    for (const Index k : one.group->dofs) reached[k] = begin.dof[k];
  return reached;
}

/// Moves each finger by this change that does not run into another one; false when none could.
bool FingerCollisionLimiter::creep(Placed& hand, const std::vector<Careful>& careful,
                                   const VectorXd& change, std::vector<Approach>& close) const {
  bool moved = false;
  std::vector<double> then;
  for (const auto& [group, approaches] : careful) {
    const auto stays = [&](Index k) { return change[k] == 0; };
    if (std::all_of(group->dofs.begin(), group->dofs.end(), stays)) continue;
    for (const Index k : group->dofs) hand.dof[k] += change[k];
    move(hand, *group);
    then.clear();
    for (const std::size_t i : approaches) {
      const double there = distance(close[i].pair, hand.placed);
      if (there < std::min(close[i].distance, 0.0) - rounding) break;
      then.push_back(there);
    }
    if (then.size() == approaches.size()) {
      for (std::size_t i = 0; i < then.size(); ++i) close[approaches[i]].distance = then[i];
      moved = true;
      continue;
    }
    for (const Index k : group->dofs) hand.dof[k] -= change[k];
    move(hand, *group);
  }
  return moved;
}

}  // namespace prehend::mapping
