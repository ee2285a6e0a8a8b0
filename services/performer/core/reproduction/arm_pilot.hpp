#pragma once

#include <functional>
#include <map>
#include <string>

#include "common/planning/plan.hpp"
#include "services/performer/core/reproduction/way.hpp"

namespace prehend::performer {

/// A long way of the hand, in the air.
struct Journey {
  arm::Joints from;  // of the arm
  Pose X_WB = Pose::Identity();
  std::vector<Pose> then = {};  // on, straight, near things
  Eigen::VectorXd dof;          // of the fingers
  std::string object;           // that it is about
  Pose X_WO = Pose::Identity();
  bool held = false;     // it is in the hand
  bool upright = false;  // and stays so
};

/// Finds such a way, or says why there is none. None: the hand flies, and needs not ask.
using Pilot = std::function<Expected<Way>(const Journey& journey)>;

struct PilotOptions {
  double speed = 0.3, turn_speed = 1.2;  // m/s, rad/s, as of a hand that flies
  /// Keeps farther from everything, and from the ends of the joints, than it need: for thoughts of
  /// what will be a little otherwise.
  bool careful = false;
};

/// Plans for an arm, by the joints, so that neither arm nor hand touches anything.
Pilot pilot_of(const planning::Robot& robot, std::map<std::string, model::Shape> shapes,
               std::map<std::string, Pose> places, const PilotOptions& how = {});

}  // namespace prehend::performer
