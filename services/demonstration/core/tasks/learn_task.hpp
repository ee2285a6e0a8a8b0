#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/tasks/shown_task.hpp"
#include "common/tasks/task_model.hpp"

namespace prehend::demonstration {

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
Expected<tasks::TaskModel> learn_task(const std::string& name,
                                      const std::vector<tasks::ShownTask>& shown,
                                      const LearnOptions& options = {});

}  // namespace prehend::demonstration
