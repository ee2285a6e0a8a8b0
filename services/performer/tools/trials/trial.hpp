#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/model/hand_model.hpp"
#include "common/planning/scene.hpp"
#include "common/tasks/task_model.hpp"
#include "services/performer/core/rehearsal/rehearsal.hpp"

namespace prehend::performer {

/// What came of a task in a world.
struct TaskTrial {
  bool rehearsed = false;  // grasps were found that hold in thought
  bool done = false;       // as it was shown, in a world where objects stand a little otherwise
  double max_error = 0;    // m, the largest of all steps; if it was performed
  double max_turn = 0;     // rad
  int planned = 0;         // steps whose grasp was found by prehend-planner; if it was rehearsed
  std::string reason;      // why it is not done
};

/// Rehearses the task among these things, then does it in a world that differs by 1 mm and 1°,
/// drawn from the seed. robot: an arm that carries the hand.
TaskTrial try_task(const model::HandModel& hand, const tasks::TaskModel& task,
                   const std::vector<Thing>& things, std::uint64_t seed,
                   const std::optional<planning::Robot>& robot = std::nullopt);

}  // namespace prehend::performer
