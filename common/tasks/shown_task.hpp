#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/pose.hpp"

namespace prehend::tasks {

/// One object was taken and put down.
struct ShownStep {
  std::string object, grasp;
  Pose X_WG_grasped = Pose::Identity();  // the hand when it had the object
  Pose X_WO_before = Pose::Identity(), X_WO_after = Pose::Identity();
  double highest = 0;                // m above W, of the object on its way
  double max_tilt = 0;               // rad, of its z axis from up, on its way
  std::map<std::string, Pose> X_WR;  // of all other objects when it was put down
};

/// What one demonstration was, in order.
using ShownTask = std::vector<ShownStep>;

}  // namespace prehend::tasks
