#pragma once

#include <set>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::planner {

/// A chain of moving links that ends somewhere.
struct FingerChain {
  int leaf = 0;             // link
  std::vector<int> joints;  // from the palm to the leaf
  std::set<int> dofs;
  Eigen::Vector3d p_LT = Eigen::Vector3d::Zero();
  double reach = 0;  // m, of the tip from the first joint, at rest
};

/// What a hand is made of, told from how its links hang together: a wrist, a palm, and fingers. Of
/// several leaves that the same DoFs move, those count that reach almost as far as the farthest. A
/// tip is the end of the last link along its bone.
class Skeleton {
 public:
  /// The hand must outlive it; it rests in the posture «open».
  explicit Skeleton(const model::HandModel& hand);

  const model::HandModel& hand() const { return hand_; }
  const model::HandJoint& joint(int i) const;
  const Eigen::VectorXd& rest() const { return rest_; }
  const std::vector<FingerChain>& fingers() const { return fingers_; }
  /// The middle of the palm, at rest.
  const Eigen::Vector3d& p_BP() const { return p_BP_; }
  /// On the palm's shapes, in B, at rest.
  std::vector<Eigen::Vector3d> palm_points() const;
  /// The tip of each finger, in B.
  std::vector<Eigen::Vector3d> tips(const Eigen::VectorXd& dof) const;
  /// Axis of a joint at rest, in B, so that a growing DoF turns about it by the right hand.
  Eigen::Vector3d axis(int joint) const;
  /// The DoF moves the whole palm, and nothing else.
  bool is_wrist(int dof) const;

 private:
  std::vector<Pose> poses(const Eigen::VectorXd& dof) const;
  void find_palm();
  void find_fingers();
  Eigen::Vector3d end_of(const FingerChain& finger) const;

  const model::HandModel& hand_;
  Eigen::VectorXd rest_;
  int palm_ = 0;            // link
  std::vector<int> wrist_;  // joints before it
  Eigen::Vector3d p_BP_;
  std::vector<FingerChain> fingers_;
};

}  // namespace prehend::planner
