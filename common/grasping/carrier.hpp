#pragma once

#include <optional>

#include "common/base/pose.hpp"
#include "common/grasping/arm.hpp"

namespace prehend::grasping {

/// Keeps the hand's base at an arm that moves as it likes. What pushes the base away from there
/// meets a force that ends at what the arm can push; then the base stays behind, and comes back
/// once it is let. Frame C is the base's centre of mass. A value, as Arm is.
class Carrier {
 public:
  /// After the next step the arm is at X_WC and can push so hard.
  void aim(const Pose& X_WC, const Push& most);

  /// The velocities for the next step of a base that is at X_WC and moves like that.
  void step(const Pose& X_WC, const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning,
            const BaseBody& base, double dt);
  const Eigen::Vector3d& velocity() const { return velocity_; }  // m/s, in W
  const Eigen::Vector3d& turning() const { return turning_; }    // rad/s, in W

  /// What has pushed against the base in that step, by how it moves now.
  BaseLoad load(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning,
                const BaseBody& base, double dt) const;

 private:
  std::optional<Pose> aim_, X_WC_;  // where the arm shall be, and is
  Push push_;
  Eigen::Vector3d arm_velocity_ = Eigen::Vector3d::Zero();  // of the arm in the last step
  Eigen::Vector3d arm_turning_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), turning_ = Eigen::Vector3d::Zero();
};

}  // namespace prehend::grasping
