#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/mapping/core/capsules.hpp"

namespace prehend::mapping {

/// Keeps commanded fingers from running into each other [Thesis, 5.1.2]. A finger that another one
/// lies in front of waits until that has moved, so fingers never come to interlock, and where they
/// lie on each other, opening lets the upper one go first, whatever the operator does. Links count
/// as capsules; pairs that overlap in the open hand are the hand's business. Pure: all that it
/// remembers is the hand's geometry. Keeps a reference to the hand.
class FingerCollisionLimiter {
 public:
  explicit FingerCollisionLimiter(const model::HandModel& hand);

  /// As much of the way from `before` to `after` as every finger can go, m or rad. Fingers that
  /// overlap already come no deeper into each other. A way that may be blocked is
  /// gone in steps of 8 mm.
  Eigen::VectorXd go(const Eigen::VectorXd& before, const Eigen::VectorXd& after) const;

  /// Distance between the fingers that are nearest to each other, m, negative where they overlap;
  /// infinite for a hand whose fingers cannot meet.
  double clearance(const Eigen::VectorXd& dof) const;

 private:
  /// Of a link.
  struct Piece {
    int link = 0, finger = 0;
    Capsule capsule_L;
  };
  struct Pair {
    std::size_t one = 0, other = 0;  // pieces of different fingers
  };
  /// DoFs that move the same fingers, and all that goes with them.
  struct Group {
    unsigned fingers = 0;  // a bit each
    std::vector<Eigen::Index> dofs;
    std::vector<std::size_t> joints, pieces;
  };
  /// Pieces that may meet, and their distance now.
  struct Approach {
    Pair pair;
    double distance = 0;
  };
  /// A group that must look where it goes, at these approaches by number.
  struct Careful {
    const Group* group = nullptr;
    std::vector<std::size_t> approaches;
  };
  /// A posture of the hand.
  struct Placed {
    Eigen::VectorXd dof;
    std::vector<Pose> X_BL;
    std::vector<Capsule> placed;  // pieces, in B
  };

  Placed place(const Eigen::VectorXd& dof) const;
  void move(Placed& hand, const Group& group) const;
  static Capsule placed_at(const Piece& piece, const Placed& hand);
  static double distance(const Pair& pair, const std::vector<Capsule>& placed);
  bool moves(const Group& group, const Pair& pair) const;
  bool creep(Placed& hand, const std::vector<Careful>& careful, const Eigen::VectorXd& change,
             std::vector<Approach>& close) const;

  const model::HandModel& hand_;
  std::vector<Piece> pieces_;
  std::vector<Pair> pairs_;
  std::vector<Group> groups_;
};

}  // namespace prehend::mapping
