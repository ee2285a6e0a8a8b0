#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/analysis/wrench_space.hpp"
#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::grasping {

struct ClosingOptions {
  /// The object cannot move while the hand closes. Otherwise it floats without gravity, damped, so
  /// that the fingers may push it to where they all touch.
  bool fixed_object = false;
  double squeeze = 1.0;  // share of each DoF's squeeze that is commanded past contact
  double speed = 1.0;    // rad/s, of the closing command (see radian_of for what slides)
  double longest = 5.0;  // s, until the fingers must have stopped
  bool volume = true;    // of the wrench space too, which is dear
  /// Of each DoF: does not close but keeps its preshape. Empty: all close that can.
  std::vector<bool> resting;
  /// Afterwards: gravity on, commanded `squeeze` past contact, and this test. None: no test.
  std::optional<HoldOptions> hold_test;
  /// Which way gravity pulls in the hold test, in B; the lift goes the other way. Unit.
  Eigen::Vector3d down_B = {0, 0, 1};
};

/// Where the fingers stopped.
struct ClosedGrasp {
  Eigen::VectorXd dof;  // the contact posture; command dof + squeeze * closing to grip
  Eigen::VectorXd joints;
  Pose X_BO;  // where the object ended up
  std::vector<analysis::Contact> contacts;
  analysis::Quality quality;
  std::optional<HoldResult> hold;
};

/// True if gears or bars move several fingers at once: the first of them to touch what cannot move
/// stops all, so that they find their places only on an object that gives way.
bool fingers_move_as_one(const model::HandModel& hand);

/// Closes the hand on an object that stands at X_BO, from the preshape along the closing direction
/// of each DoF, in a Bullet world of its own. Deterministic; several threads may call it at once.
/// Fails when the preshape already penetrates the object, when sizes or values are wrong, or when
/// fewer than two contacts are made.
Expected<ClosedGrasp> close_hand(const model::HandModel& hand, const Body& object, const Pose& X_BO,
                                 const Eigen::VectorXd& preshape,
                                 const ClosingOptions& options = {});

}  // namespace prehend::grasping
