#pragma once

#include <memory>
#include <optional>

#include "common/arm/controller.hpp"
#include "common/arm/dynamics.hpp"
#include "common/base/error.hpp"
#include "common/grasping/world.hpp"
#include "common/model/arm_model.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::carrying {

/// What an arm was told in the last step, and what it does.
struct ArmMotion {
  arm::Joints told, told_velocity;  // rad, rad/s
  arm::Joints joint;                // rad
  arm::Joints torque;               // N m, of the drives
  Pose X_WB;                        // of the hand, by these joints
  double off_m = 0, off_rad = 0;    // from the wish
  arm::Hindrance hindrance = arm::Hindrance::none;
  double carried = 0;  // kg: the hand, and what it has lifted
  bool too_heavy = false;
};

/// The arm at the robot's side of the gate: leads its joints after the wish, in steps of the world,
/// and carries the hand's base there. What the hand touches pushes back: the drives hold that up to
/// their torques, and what is much too heavy is not lifted. Its links touch nothing in the world;
/// the controller keeps them away from the table and each other. Keeps a reference to the hand.
class CarryingArm {
 public:
  /// X_WA: where it stands. X_EB: how it holds the hand. Fails when it cannot carry that.
  static Expected<std::unique_ptr<CarryingArm>> create(model::ArmModel arm,
                                                       const model::HandModel& hand,
                                                       const Pose& X_WA, const Pose& X_EB);
  CarryingArm(const CarryingArm&) = delete;
  CarryingArm& operator=(const CarryingArm&) = delete;

  /// The hand's base as the world needs it for that.
  static grasping::BaseBody base();
  /// Where the hand is at home.
  Pose home() const;

  void start(const arm::Joints& q);  // it is there, at rest; at first: at home
  void follow(const Pose& X_WB);     // from now on
  void brake();                      // as hard as it can, and stays there until the next wish
  bool rests() const;

  /// The joints of the next step of the world, which carries the hand there.
  void step(grasping::World& world);
  ArmMotion motion(const grasping::World& world) const;

  const model::ArmModel& model() const { return arm_; }
  const arm::Joints& posture() const { return controller_.posture(); }
  const Pose& X_WA() const { return options_.X_WA; }
  const Pose& X_EB() const { return options_.X_EB; }

 private:
  CarryingArm(model::ArmModel arm, const model::HandModel& hand, arm::ControllerOptions options);
  void feel(const grasping::World& world);
  Pose bounded(const Pose& X_WB) const;
  arm::Joints torques(const arm::Joints& q, const arm::Burden& burden) const;

  model::ArmModel arm_;
  arm::ControllerOptions options_;
  arm::Controller controller_;
  arm::Burden burden_;  // of the hand alone
  grasping::BaseLoad load_;
  double lifted_ = 0;  // N, downwards, smoothed
  bool too_heavy_ = false;
  std::optional<Pose> wish_;
  Pose X_WB_;            // of the hand in the world
  bool pushed_ = false;  // away from the arm
  arm::Guidance guidance_;
  arm::Joints acceleration_;
};

}  // namespace prehend::carrying
