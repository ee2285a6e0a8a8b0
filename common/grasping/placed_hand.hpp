#pragma once

#include <memory>
#include <optional>

#include "common/grasping/arm.hpp"
#include "common/grasping/carrier.hpp"
#include "common/grasping/hand_body.hpp"
#include "common/grasping/world.hpp"

namespace prehend::grasping {

/// A hand in a world with what it was told, and what carries its base. Functions are those of World
/// of the same name. Keeps references to all that it is made of.
class PlacedHand {
 public:
  /// number: of the hand in its world. Fails as command(), and on links of unknown materials.
  static Expected<std::unique_ptr<PlacedHand>> create(const model::HandModel& hand, int number,
                                                      const Pose& X_WB, const Eigen::VectorXd& dof,
                                                      const WorldOptions& options,
                                                      btMultiBodyDynamicsWorld& bullet,
                                                      LinkPairFilter& filter);

  Expected<void> place(const Pose& X_WB, const Eigen::VectorXd& dof);
  Expected<void> command(const Pose& X_WB, const Eigen::VectorXd& dof,
                         const Eigen::Vector3d& velocity);
  Expected<void> limit_effort(const Eigen::VectorXd& effort);
  void hold_still();
  void brake();
  void carry(const Pose& X_WB, const Push& most);
  BaseLoad base_load() const;

  /// Sets base and drives for the next step.
  void drive();
  /// The same as `other`, to the bit, but carried by nobody; of the same hand.
  void copy_state(const PlacedHand& other);

  const model::HandModel& model() const { return hand_; }
  const HandBody& body() const { return body_; }
  HandMotion motion() const;
  const Pose& commanded_base() const { return X_WB_command_; }
  const Eigen::VectorXd& commanded_dof() const { return dof_command_; }

 private:
  PlacedHand(const model::HandModel& hand, const std::vector<analysis::Material>& materials,
             const WorldOptions& options, btMultiBodyDynamicsWorld& bullet, LinkPairFilter& filter,
             int number);
  ArmLimits arm_limits() const;

  const model::HandModel& hand_;
  const WorldOptions& options_;
  double dt_;  // s
  HandBody body_;
  Pose X_WB_command_;
  Eigen::Vector3d velocity_command_ = Eigen::Vector3d::Zero();
  Eigen::VectorXd dof_command_;
  Eigen::VectorXd effort_;  // that the DoFs may use; empty: all they have
  bool braking_ = false;
  Arm arm_;
  std::optional<Carrier> carrier_;
};

}  // namespace prehend::grasping
