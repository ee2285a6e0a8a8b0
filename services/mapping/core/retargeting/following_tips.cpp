#include "services/mapping/core/retargeting/following_tips.hpp"

#include <utility>

namespace prehend::mapping {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Expected<FollowingTips> FollowingTips::create(const model::HandModel& hand) {
  FollowingTips made(hand);
  for (std::size_t i = 0; i < hand.fingertips().size(); ++i)
    if (const auto& human = hand.fingertips()[i].human)
      made.tips_.push_back({static_cast<int>(i), *human});
  if (made.tips_.empty())
    return fail("no fingertip follows a human one", hand.name(),
                "name the human finger in its hand.toml: human = \"index\"");

  const Matrix3Xd open = made.positions(hand.postures().at("open"));
  for (Tip& tip : made.tips_) {
    double sum = 0, own = 0;
    int followers = 0;
    for (int i = 0; i < made.count(); ++i) {
      const Tip& other = made.tips_[static_cast<std::size_t>(i)];
      if (other.human != tip.human) continue;
      sum += open(0, i);
      ++followers;
      if (&other == &tip) own = open(0, i);
    }
    tip.beside_G.x() = own - sum / followers;
  }
  return made;
}

Matrix3Xd FollowingTips::positions(const VectorXd& dof) const {
  const std::vector<Pose> X_BL = hand_->link_poses(hand_->joint_angles(dof));
  const Pose X_GB = hand_->X_BG().inverse();
  Matrix3Xd p_GT(3, count());
  for (int i = 0; i < count(); ++i) {
    const auto& tip = hand_->fingertips()[static_cast<std::size_t>(tips_[i].fingertip)];
    p_GT.col(i) = X_GB * (X_BL[static_cast<std::size_t>(tip.link)] * tip.p_LT);
  }
  return p_GT;
}

Matrix3Xd FollowingTips::positions(const VectorXd& dof, MatrixXd& jacobian) const {
  const std::vector<Pose> X_BL = hand_->link_poses(hand_->joint_angles(dof));
  const Pose X_GB = hand_->X_BG().inverse();
  Matrix3Xd p_GT(3, count());
  jacobian.setZero(3 * count(), dof.size());
  for (int i = 0; i < count(); ++i) {
    const auto& tip = hand_->fingertips()[static_cast<std::size_t>(tips_[i].fingertip)];
    const Vector3d p_BT = X_BL[static_cast<std::size_t>(tip.link)] * tip.p_LT;
    p_GT.col(i) = X_GB * p_BT;
    // Every joint between the tip and the base turns or slides it.
    for (int link = tip.link; link > 0;) {
      const model::HandJoint& joint = hand_->joints()[static_cast<std::size_t>(
          hand_->links()[static_cast<std::size_t>(link)].joint)];
      const Pose& X_BJ = X_BL[static_cast<std::size_t>(link)];
      const Vector3d axis_B = X_BJ.linear() * joint.axis_J;
      const Vector3d motion_B = joint.kind == model::JointKind::revolute
                                    ? axis_B.cross(p_BT - X_BJ.translation())
                                    : axis_B;
      jacobian.block<3, 1>(3 * i, joint.dof) += joint.multiplier * (X_GB.linear() * motion_B);
      link = joint.parent;
    }
  }
  return p_GT;
}

Expected<Matrix3Xd> FollowingTips::targets(const HumanTips& human) const {
  Matrix3Xd p_GT(3, count());
  for (int i = 0; i < count(); ++i) {
    const Tip& tip = tips_[static_cast<std::size_t>(i)];
    const auto& followed = human[static_cast<std::size_t>(tip.human)];
    if (!followed) return fail("fingertip missing");
    if (!followed->allFinite()) return fail("fingertip not finite");
    p_GT.col(i) = *followed + tip.beside_G;
  }
  return p_GT;
}

}  // namespace prehend::mapping
