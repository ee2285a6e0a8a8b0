#pragma once

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/pose.hpp"
#include "common/grasping/arm.hpp"
#include "common/grasping/gear.hpp"
#include "common/grasping/surface.hpp"
#include "common/model/hand_model.hpp"

class btMultiBodyDynamicsWorld;

namespace prehend::grasping {

/// Pairs of links of one hand that overlap when it rests, as neighbours do, never collide. One of a
/// world, for all its hands.
struct LinkPairFilter : btOverlapFilterCallback {
  std::map<int, std::vector<std::pair<int, int>>> ignored;  // of each hand, smaller number first

  bool ignores(int hand, int a, int b) const;
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;
};

/// The hand in a Bullet world: a Featherstone multibody with a collider on each link, a drive and
/// limits on each joint; a joint that gears or bars move has a gear in place of a drive, and what
/// drives it stands at the joint that moves it. Each drive is a spring that reaches its joint's
/// torque limit when the command is the DoF's squeeze ahead, no faster than the DoF's velocity
/// limit, and pushes with no more than the effort that the DoF may use. The base moves as it is
/// told, whatever the hand touches. Link and joint numbers are those of the model; values are rad
/// and N m, or m and N of a joint that slides.
///
/// A joint with a clutch that is blocked with the breakaway torque is let go: it stays where it is,
/// still pressed with that torque and held against opening with its whole torque, as by a worm
/// gear, while the motor goes on with the joints coupled to it. While the motor goes back, nothing
/// presses the joint on; driven back to where it let go, the motor takes it again.
class HandBody {
 public:
  /// materials: of each link. number: of the hand in its world. World and filter must outlive the
  /// hand.
  HandBody(const model::HandModel& hand, const std::vector<analysis::Material>& materials,
           btMultiBodyDynamicsWorld& world, LinkPairFilter& filter, double time_step,
           const BaseBody& base = {}, int number = 0);
  ~HandBody();
  HandBody(const HandBody&) = delete;
  HandBody& operator=(const HandBody&) = delete;

  /// Puts the hand there with its colliders, the base at rest and every clutch engaged.
  void place(const Pose& X_WB, const Eigen::VectorXd& joint, const Eigen::VectorXd& velocity);
  /// The same as `other`, to the bit; of the same hand.
  void copy_state(const HandBody& other);
  /// Sets the drives for the next step towards these values of the DoFs. effort: what each DoF may
  /// use, N m or N; empty: all it has.
  void drive(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort);
  /// The base's velocities for the next step, of its centre of mass. m/s, rad/s, in W.
  void move_base(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning);
  Eigen::Vector3d base_velocity() const;  // as it is, after what the hand has touched
  Eigen::Vector3d base_turning() const;

  Pose X_WB() const;
  /// C: at the base's centre of mass, along the axes of B.
  Pose X_WC() const;
  Pose X_WC_of(const Pose& X_WB) const;
  double joint(int i) const { return multibody_->getJointPos(i); }
  double velocity(int i) const { return multibody_->getJointVel(i); }
  double torque(int i) const;  // that the drive applied in the last step; 0: it has none
  /// Where the motor of a DoF is: with the joint that it leads, or, while its clutch has let that
  /// go, with the joint coupled to it.
  double motor(int dof) const;
  double motor_velocity(int dof) const;
  /// How a link moves, in W: m/s at its centre of mass C, rad/s.
  struct LinkMotion {
    Eigen::Vector3d p_WC, velocity, turning;

    Eigen::Vector3d velocity_at(const Eigen::Vector3d& p_W) const {
      return velocity + turning.cross(p_W - p_WC);
    }
  };
  std::vector<LinkMotion> link_motions() const;
  /// False for links that overlap when the hand rests.
  bool may_touch(int link, int other) const;
  const std::vector<std::unique_ptr<btMultiBodyLinkCollider>>& colliders() const {
    return colliders_;
  }

 private:
  /// Between a DoF's motor and the joint that it leads.
  struct Clutch {
    int follower = -1;               // a joint coupled to the leading one; -1: no clutch
    double blocked = 0;              // s, for which the joint has been blocked
    std::optional<double> released;  // where it was let go
    double farthest = 0;             // of the motor since then
    std::optional<double> locked;    // where its gear holds it while the motor goes back
  };

  void build_links(const BaseBody& base);
  void build_colliders(const std::vector<analysis::Material>& materials);
  void ignore_overlaps();
  void build_drives();
  void build_gear(int joint);
  void update_clutch(int dof, double command);
  void move_colliders();

  const model::HandModel& hand_;
  btMultiBodyDynamicsWorld& world_;
  LinkPairFilter& filter_;
  double time_step_;
  int number_;
  Eigen::VectorXd max_effort_;      // of each DoF
  std::vector<double> max_torque_;  // of each joint's drive, for itself and what is geared to it
  std::deque<Surface> surfaces_;    // stable addresses
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::unique_ptr<btMultiBody> multibody_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btMultiBodyJointMotor>> motors_;  // of each joint; null: geared
  std::vector<std::unique_ptr<Gear>> gears_;
  std::vector<std::unique_ptr<btMultiBodyJointLimitConstraint>> limits_;
  std::vector<Clutch> clutches_;  // of each DoF
};

}  // namespace prehend::grasping
