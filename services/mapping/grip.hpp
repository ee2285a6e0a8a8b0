#pragma once

#include <Eigen/Core>
#include <optional>
#include <prehend/base/pose.hpp>
#include <prehend/base/time.hpp>
#include <prehend/model/hand_model.hpp>
#include <vector>

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

/// Angles are of what turns; what slides counts by radian_of().
struct GripOptions {
  double squeeze = 0.15;      // rad, commanded past contact
  double open = 0.10;         // rad, by which the operator opens to let go
  double lag = 0.05;          // rad, behind its command, that means something is in the way
  double torque_share = 0.9;  // of the limit, that means the same
  double still = 0.02;        // rad, that it may move meanwhile: drives under load chatter
  double arrived = 0.02;      // rad, behind its command, that means nothing is in the way
  Duration settle = std::chrono::milliseconds(100);  // for which it must last
};

/// What 1 rad of a finger is for this DoF where closing is meant: 1, or the length of a slide that
/// grips as hard.
double radian_of(const model::HandDof& dof);

/// Remembers where each closing finger was stopped first, and squeezes by the same angle in every
/// mode: a contact posture reproduced exactly would grip with no force, and a drive pressed to its
/// limit has no stiffness left, so that a thin object slips from between the fingers. What does not
/// close (spread) stays as it is while anything is touched. Keeps a reference to the hand.
class Grip {
 public:
  Grip(const model::HandModel& hand, const GripOptions& options);

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
