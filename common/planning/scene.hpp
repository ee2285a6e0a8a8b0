#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/arm/kinematics.hpp"
#include "common/model/arm_model.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"

namespace prehend::planning {

/// A hand on an arm. Both models must outlive it.
struct Robot {
  const model::ArmModel* arm = nullptr;
  const model::HandModel* hand = nullptr;
  Pose X_WA = Pose::Identity();  // where the arm stands
  Pose X_EB = Pose::Identity();  // how its end holds the hand

  /// X_WB of the hand with the arm in this posture.
  Pose hand_at(const arm::Joints& q) const { return X_WA * arm::end_pose(*arm, q) * X_EB; }
  /// X_AE of the arm with the hand there.
  Pose end_for(const Pose& X_WB) const { return X_WA.inverse() * X_WB * X_EB.inverse(); }
};

/// A solid. Where it has parts, these touch in place of its shape.
struct Solid {
  std::string name;
  model::Shape shape;
  std::vector<std::vector<Eigen::Vector3d>> parts = {};  // corners of convex pieces, in O, m
};

/// One that stands in the way.
struct Obstacle {
  Solid solid;
  Pose X_WO = Pose::Identity();
};

/// One that the hand holds, fixed to its base.
struct Held {
  Solid solid;
  Pose X_BO = Pose::Identity();
};

/// What is around the arm, and how its hand is.
struct Scene {
  bool table = true;    // the plane z = 0 of W
  Eigen::VectorXd dof;  // of the hand; empty: open
  std::vector<Obstacle> obstacles;
  std::optional<Held> held;
};

}  // namespace prehend::planning
