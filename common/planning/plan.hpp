#pragma once

#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/planning/trajectory.hpp"

namespace prehend::planning {

/// A way of the hand by its arm.
struct Query {
  Scene scene;
  arm::Joints start;  // at rest
  Pose X_WB = Pose::Identity();
  std::optional<Upright> upright = std::nullopt;
  /// Straight ways from X_WB on, one after the other, on which the hand comes near to things: the
  /// arm must be able to go them from the posture in which it arrives. What is held is left aside.
  std::vector<Pose> then = {};
  std::string touched = {};  // an obstacle that the hand may touch on these
};

struct PlanOptions {
  /// How near arm, hand and what it holds may come to things.
  RoomOptions room;
  /// m, that the hand keeps from things on the ways that come after.
  double contact_clearance = 0.001;
  /// m, that the arm keeps on these, if it was not nearer before.
  double arm_contact_clearance = 0.012;
  /// How long a way is searched.
  SearchOptions search;
  /// How fast the arm goes along it.
  Pace pace;
};

/// Joints from where the arm is to where its hand shall be: of all branches of the inverse
/// kinematics the nearest that is free, dexterous and allows what comes after. Neither arm, hand
/// nor what it holds comes nearer to anything than allowed. Pure; the same each time. Fails, with
/// the reason, where the start is not free, no branch is, or no way is found.
Expected<Trajectory> plan(const Robot& robot, const Query& query, const PlanOptions& options = {});

/// The postures of a straight way of the hand, a centimetre apart, on the branch of the first.
/// Fails, saying where and why, if the arm cannot go it.
Expected<Path> straight_way(const Robot& robot, const Room& room, const arm::Joints& from,
                            const Pose& X_WB);

}  // namespace prehend::planning
