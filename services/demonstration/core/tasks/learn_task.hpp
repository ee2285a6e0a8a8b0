#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "services/demonstration/core/tasks/task_model.hpp"

namespace prehend::demonstration {

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

struct LearnOptions {
  double near = 0.15;          // m: of one demonstration, within this an object is the reference
  double upright_tilt = 0.26;  // rad: what never tilts more stays upright
  double min_spread = 0.002;   // m: smaller differences of spread are chance
};

/// What demonstrations of the same task have in common. The place of each object is taken relative
/// to that other object, or the table, relative to which it differs least; of a single
/// demonstration, relative to the nearest object within 15 cm, else the table. Steps that came in
/// the same order in all demonstrations keep it where they have an object in common, and so does a
/// reference that is put down before. Fails on demonstrations that move other things.
Expected<TaskModel> learn_task(const std::string& name, const std::vector<ShownTask>& shown,
                               const LearnOptions& options = {});

}  // namespace prehend::demonstration
