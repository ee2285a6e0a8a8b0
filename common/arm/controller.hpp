#pragma once

#include <optional>
#include <string_view>

#include "common/arm/collision.hpp"
#include "common/arm/kinematics.hpp"

namespace prehend::arm {

/// Where the hand's base shall be, and how it moves there: m/s and rad/s, in W. Without a velocity
/// the arm comes to rest there.
struct Wish {
  Pose X_WB = Pose::Identity();
  Vector6 velocity_W = Vector6::Zero();
};

/// What keeps the hand from being where it is wished.
enum class Hindrance {
  none,         // it is there
  on_the_way,   // it goes there as fast as the joints may
  joint_limit,  // a joint is at its end
  collision,    // the arm would come too near to itself or to the table
  reach,        // no posture near this one brings it nearer
  no_wish       // the wish cannot be meant: the arm brakes
};
std::string_view to_string(Hindrance hindrance);

/// What the arm shall do now, and how far that is from the wish.
struct Guidance {
  Joints q;         // rad
  Joints velocity;  // rad/s
  Pose X_WB;        // where the hand then is: as near to the wish as it could come
  double off_m = 0, off_rad = 0;
  Hindrance hindrance = Hindrance::none;
};

struct ControllerOptions {
  /// Where the arm's base A stands on the table W.
  Pose X_WA = Pose::Identity();
  /// How the arm's end E holds the hand's base B.
  Pose X_EB = Pose::Identity();
  /// The table, and the shapes of the hand that the arm carries.
  Surroundings surroundings;
  /// m. No link comes nearer than this to the table, to the hand or to another link.
  double clearance = 0.01;
  /// m. A link that is nearer than this to something moves the slower towards it the nearer it is.
  double slowing = 0.06;
  /// m. How turns are weighed against distances: 1 rad off the wish is as bad as this many metres.
  double lever = 0.15;
  /// The joints are damped where the smallest singular value of the Jacobian is below this.
  double singular = 0.06;
  /// The damping at the singularity itself; it grows from 0 to this as the singular value falls.
  double max_damping = 0.08;
};

/// Leads an arm after a moving hand, at the rate of the commands. It goes from posture to posture
/// by small steps, so it never jumps to another branch. Velocity, acceleration and range of each
/// joint hold in every step. Each step is one from which the arm can brake to rest without coming
/// nearer to anything than allowed; so it never has to choose between two wrongs. Pure: the same
/// calls give the same answers. Keeps a reference to the arm.
class Controller {
 public:
  Controller(const model::ArmModel& arm, ControllerOptions options);

  /// The arm is here, at rest.
  void start(const Joints& q);
  /// The next step of `dt` s (0 to 0.1).
  Guidance step(const Wish& wish, double dt);
  /// Brakes as hard as the joints may.
  Guidance brake(double dt);

  const Joints& posture() const { return q_; }
  const Joints& velocity() const { return v_; }

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, model::max_arm_joints,
                               model::max_arm_joints>;
  /// What a velocity must keep to for one step.
  struct Bounds {
    Joints lower, upper;
  };
  struct Aim {
    Joints velocity;
    Square metric;        // how much a velocity that is off moves E
    bool slowed = false;  // by what is near
  };

  Bounds bounds(double dt) const;
  Joints braking(double dt) const;
  Aim towards(const Configuration& at, const Pose& X_AE_wish, const Vector6& velocity_A,
              double dt) const;
  Joints escape(const Eigen::MatrixXd& directions, const Pose& X_AE, const Pose& X_AE_wish) const;
  void keep_away(const Configuration& at, const Bounds& bounds, Aim& aim) const;
  bool is_safe(const Joints& velocity, double dt) const;
  Guidance answer(const std::optional<Pose>& X_AE_wish, Hindrance hindrance) const;
  bool at_limit(const Joints& wanted) const;

  const model::ArmModel& arm_;
  ControllerOptions options_;
  Collision collision_;
  Pose X_AW_, X_BE_;
  double bend_;   // m: how much the ways of E bend with the joints
  Joints lever_;  // m, see levers()
  Joints q_, v_;
};

}  // namespace prehend::arm
