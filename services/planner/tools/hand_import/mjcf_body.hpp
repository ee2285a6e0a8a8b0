#pragma once

#include <map>
#include <string>

#include "services/planner/tools/hand_import/mjcf_source.hpp"

namespace prehend::planner {

/// What a joint of MJCF says that RobotJoint has no place for.
struct MjcfJoint {
  const tinyxml2::XMLElement* at = nullptr;
  double ref = 0;           // its value where the model stands as written
  double stiffness = 0;     // of its spring, N m/rad or N/m
  double springref = 0;     // where the spring rests
  double effort_bound = 0;  // of all actuators together; 0: not said
};

/// The links of the hand and its joints, whose own properties are read but nothing between them.
struct MjcfTree {
  Robot robot;                              // without findings
  std::map<std::string, MjcfJoint> joints;  // of the robot's joints, those that move
  std::map<std::string, Pose> bodies;       // X_LN: N: the body's frame in its link's
  std::map<std::string, std::pair<std::string, Pose>> sites;  // link and X_LS of <site>s
};

/// Makes links of <worldbody>. Findings are the source's.
MjcfTree read_bodies(MjcfSource& source);

/// X_JC: how far a joint has moved its child at a value.
Pose motion(const RobotJoint& joint, double value);

}  // namespace prehend::planner
