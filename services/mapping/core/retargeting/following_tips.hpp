#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::mapping {

/// p_GT of a person's fingertips in the grasp frame of the hand (see model/placement.hpp), m; none
/// where the glove does not say.
using HumanTips = std::array<std::optional<Eigen::Vector3d>, model::finger_count>;

/// The fingertips of a robot hand that follow human ones (`human` in hand.toml), in the order of
/// the hand's description. G: the hand's grasp frame, so that robot and human tips compare. Keeps a
/// reference to the hand.
class FollowingTips {
 public:
  /// Fails when no fingertip of the hand follows a human one.
  static Expected<FollowingTips> create(const model::HandModel& hand);

  int count() const { return static_cast<int>(tips_.size()); }
  const model::HandModel& hand() const { return *hand_; }

  /// p_GT of the tips, a column each, m.
  Eigen::Matrix3Xd positions(const Eigen::VectorXd& dof) const;
  /// The same and their derivatives: d positions / d dof, three rows a tip.
  Eigen::Matrix3Xd positions(const Eigen::VectorXd& dof, Eigen::MatrixXd& jacobian) const;

  /// Where the tips shall be for these human ones. Those that follow the same human finger stay as
  /// far apart along x of G as in the open hand. Fails when a human tip that is followed is missing
  /// or not finite.
  Expected<Eigen::Matrix3Xd> targets(const HumanTips& human) const;

 private:
  struct Tip {
    int fingertip = 0;  // of the hand
    model::Finger human{};
    Eigen::Vector3d beside_G = Eigen::Vector3d::Zero();  // m, from the human tip
  };
  explicit FollowingTips(const model::HandModel& hand) : hand_(&hand) {}

  const model::HandModel* hand_;
  std::vector<Tip> tips_;
};

}  // namespace prehend::mapping
