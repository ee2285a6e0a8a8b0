#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::mapping {

/// What the robot hand says of itself.
struct RobotState {
  Time stamp;
  // Of what slides, m, m/s and N stand for rad, rad/s and N m.
  Eigen::VectorXd dof;       // rad
  Eigen::VectorXd velocity;  // rad/s, of the joints
  Eigen::VectorXd torque;    // N m, of the joints
  Pose X_WB = Pose::Identity();
};

/// Angles are of what turns; what slides counts by model::radian_of().
struct GripOptions {
  /// A finger that is stopped is commanded this angle past its contact, rad.
  double squeeze = model::full_squeeze;
  /// The operator lets go of a contact by opening the finger by this angle from it, rad.
  double open = 0.10;
  /// Something is in the way of a finger that is further than this angle behind its command, rad.
  double lag = 0.05;
  /// Something is in the way of a joint whose torque is above this share of its limit.
  double torque_share = 0.9;
  /// A finger that moves no more than this angle stands still, rad: drives under load chatter.
  double still = 0.02;
  /// Nothing is in the way of a finger that is no further than this angle behind its command, rad.
  double arrived = 0.02;
  /// A finger is stopped once it has pushed and stood still for this time.
  Duration settle = std::chrono::milliseconds(100);
};

/// Remembers where each closing finger was stopped first, and squeezes by the same angle in every
/// mode: a contact posture reproduced exactly would grip with no force, and a drive pressed to its
/// limit has no stiffness left, so that a thin object slips from between the fingers. What does not
/// close (spread) stays as it is while anything is touched. Keeps a reference to the hand.
class GripController {
 public:
  GripController(const model::HandModel& hand, const GripOptions& options);

  /// commanded: what the hand was last told; empty when nothing yet (then only torque counts).
  /// The state's sizes must be those of the hand.
  void observe(const RobotState& state, const Eigen::VectorXd& commanded);

  /// Lets go of fingers that the operator opens; the others are told their contact and the squeeze.
  Eigen::VectorXd squeeze(const Eigen::VectorXd& mapped);

  bool touching() const;
  /// Contact posture of each DoF, rad or m; empty where there is none.
  const std::vector<std::optional<double>>& contacts() const { return contacts_; }

 private:
  struct Stop {
    Time since;
    double dof = 0;  // rad or m, at that time
  };
  bool pushing(std::size_t dof, const RobotState& state, const Eigen::VectorXd& commanded) const;

  const model::HandModel& hand_;
  GripOptions options_;
  std::vector<std::optional<double>> contacts_;
  std::vector<std::optional<Stop>> stops_;  // fingers that push and do not move
  std::optional<Eigen::VectorXd> held_;     // the command at the first touch
};

}  // namespace prehend::mapping
