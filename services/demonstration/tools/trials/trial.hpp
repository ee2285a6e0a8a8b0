#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/planning/scene.hpp"
#include "services/demonstration/core/observation/watcher.hpp"
#include "services/demonstration/core/person/person.hpp"
#include "services/demonstration/core/reproduction/task_performer.hpp"
#include "services/demonstration/core/tasks/task_model.hpp"

namespace prehend::demonstration {

/// What a watcher understands of a person, seen with the noise of sensors and hidden in the hand.
Expected<Demonstration> watched(const Person& person, const std::string& task, std::uint64_t seed);

/// One task that was drawn, shown once, moved elsewhere and done again in a world.
struct TaskTrial {
  int steps = 0;
  bool understood = false;  // it was learnt, and steps are the right ones
  bool rehearsed = false;   // grasps were found that hold in thought
  bool done = false;        // as it was shown, in a world where objects stand a little otherwise
  double max_error = 0;     // m, the largest of all steps; if it was performed
  double max_turn = 0;      // rad
  std::string reason;       // why it is not done
};

/// A task with so many steps, each with another object that the hand can take. The world in which
/// it is done differs from that in which it was rehearsed by 1 mm and 1°.
/// robot: an arm that carries the hand; then things stand on that part of the table that it
/// reaches.
TaskTrial try_task(const model::HandModel& hand, const model::Catalogue& catalogue, int steps,
                   std::uint64_t seed, const std::optional<planning::Robot>& robot = std::nullopt);

}  // namespace prehend::demonstration
