#pragma once

#include <Eigen/Core>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/finger_distances.hpp"
#include "services/mapping/core/object_tracks.hpp"
#include "services/mapping/core/target_selector.hpp"

namespace prehend::mapping {

struct PlacementOptions {
  /// The hand's grasp frame is moved by at most this distance, m.
  double max_distance = 0.03;
  /// The hand's grasp frame is turned by at most this angle, rad (20°).
  double max_angle = 0.349066;
  /// The correction changes by at most this speed, m/s.
  double speed = 0.15;
  /// The correction turns by at most this speed, rad/s.
  double turn_speed = 1.5;
  /// A finger that is nearer to the object than this distance makes the hand yield, m.
  double yield = 0.006;
};

/// The grasp frame X_WG moved toward X_WG_grasp, as near as max_distance (m) and max_angle (rad)
/// allow: turned first and moved sideways, so that the fingers go past the object on both sides.
/// The way along the approach is the operator's, until no more of it is left than can be corrected.
Pose toward(const Pose& X_WG, const Pose& X_WG_grasp, double max_distance, double max_angle);

/// How far a hand must move, m, so that a finger nearer than `room` (m) to an object does not push
/// it while those on the other side are still on their way: then the hand yields instead of the
/// object. before, after: distance of each finger, m, were the hand moved by −step and +step.
double yielding(const Eigen::ArrayXd& before, const Eigen::ArrayXd& after, double step,
                double room);

/// Where the robot hand's base goes: to the human hand, corrected toward the grasp of an object.
/// The correction moves at a limited speed, and with the hand. Keeps a reference to the hand.
class Placement {
 public:
  Placement(const model::HandModel& hand, const PlacementOptions& options)
      : hand_(hand), options_(options) {}

  /// The correction of a robot hand that is at X_WB already, as far as it may be corrected.
  void start(const Pose& X_WG, const Pose& X_WB);
  /// There is nothing to correct the placement to.
  void release();
  /// Moves the aim along y of the target's grasp, in which fingers close, so that the posture `dof`
  /// does not push the object (see yielding()).
  void yield(const GraspTarget& target, const Detection& object, const FingerDistances& fingers,
             const Eigen::VectorXd& dof);
  /// Corrects toward the target's grasp, from where this hand stands in it, and by how far the hand
  /// yields.
  void aim(const Pose& X_WG, const GraspTarget& target);
  /// The correction goes on to where it shall be. weight: share of it, 0 to 1.
  void follow(double weight, Duration elapsed);

  /// The base for a human hand whose grasp frame is at X_WG.
  Pose X_WB(const Pose& X_WG) const;
  /// The human hand's grasp frame for a base at X_WB.
  Pose X_WG(const Pose& X_WB) const;

 private:
  Pose place_of(const GraspTarget& target) const;

  const model::HandModel& hand_;
  PlacementOptions options_;
  double yielded_ = 0;                       // m, along y of the target's grasp
  Pose full_correction_ = Pose::Identity();  // X_GG', the correction for weight 1
  Pose correction_ = Pose::Identity();       // X_GG', the correction in force
};

}  // namespace prehend::mapping
