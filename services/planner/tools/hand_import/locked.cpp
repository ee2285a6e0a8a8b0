#include "services/planner/tools/hand_import/locked.hpp"

#include <fmt/format.h>

#include "services/planner/tools/hand_import/tree.hpp"

namespace prehend::planner {
namespace {

/// Fixed where it stands at this value.
void fix(RobotJoint& joint, double value) {
  const double length = joint.axis_J.norm();
  if (length > 1e-9) {
    const Eigen::Vector3d axis = joint.axis_J / length;
    if (joint.slides())
      joint.X_PJ.translate(value * axis);
    else
      joint.X_PJ.rotate(Eigen::AngleAxisd(value, axis));
  }
  joint.type = "fixed";
  joint.mimic.reset();
}

}  // namespace

bool is_locked(const RobotJoint& joint) {
  return joint.moves() && joint.type != "continuous" && joint.limit && joint.limit->has_range &&
         joint.limit->lower == joint.limit->upper;
}

Robot without_locked(Robot robot, std::vector<std::string>& changes) {
  const std::vector<double> values = rest_values(robot);
  Robot fixed = robot;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (!robot.joints[i].moves()) continue;
    const auto leader = leader_of(robot, i);
    if (!leader) continue;  // an error, which check() tells
    const RobotJoint& leads = robot.joints[leader->joint];
    const bool follows_nothing = robot.joints[i].mimic && leader->multiplier == 0;
    if (!is_locked(robot.joints[i]) && !is_locked(leads) && leads.moves() && !follows_nothing)
      continue;
    const double value = robot.joints[i].mimic && is_locked(robot.joints[i])
                             ? robot.joints[i].limit->lower
                             : values[i];
    fix(fixed.joints[i], value);
    changes.push_back(
        fmt::format("joint {}: cannot move, held at {:.3g}", robot.joints[i].name, value));
  }
  return fixed;
}

}  // namespace prehend::planner
