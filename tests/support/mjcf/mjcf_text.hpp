#pragma once

#include <string>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::test {

/// How a robot is written as MJCF, each being an other way of saying the same.
struct MjcfStyle {
  bool degrees = false;   // MuJoCo's default
  bool defaults = false;  // types, axes and contacts by classes, frames by <frame>
  bool moved = false;     // joints stand beside their bodies' frames, and have a ref
};

/// A sound robot of boxes, cylinders and spheres as MJCF: links as bodies, <mimic> as equalities. A
/// moved body has its frame elsewhere than the link, by moved_by() in the link's frame.
std::string mjcf_of(const planner::Robot& robot, const MjcfStyle& style);

/// Two slides, the right one coupled to the left one; a floor and a cube are in its world.
std::string mjcf_gripper();
/// By classes of defaults: one finger pulled by a tendon, one coupled by an equality, one that has
/// a joint of its base beside the next and a last one that only a spring moves. Shows shell.stl and
/// tip.obj.
std::string mjcf_three_fingers();

/// Two fingers, each a parallelogram: the crank is driven, coupler and rocker meet by <connect>,
/// but for a toe of the coupler that a spring presses against its stop. The couplers carry the
/// pads.
std::string mjcf_linkages();

/// X_LN: N: the frame of a body that is moved.
Pose moved_by();

}  // namespace prehend::test
