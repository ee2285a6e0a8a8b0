#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/scene.hpp"
#include "common/tasks/task_model.hpp"
#include "services/demonstration/core/observation/watcher.hpp"
#include "services/demonstration/core/person/person.hpp"

namespace prehend::demonstration {

/// What a watcher understands of a person, seen with the noise of sensors and hidden in the hand.
Expected<Demonstration> watched(const Person& person, const std::string& task, std::uint64_t seed);

/// A task that was drawn and shown once, by a person who does not exist.
struct ShownTrial {
  tasks::TaskModel task;    // as it was learnt
  bool understood = false;  // its steps are the right ones
  model::Scene again;       // where its objects stand when it shall be done again
};

/// One with so many steps, each with another object that the hand can take. by_arm: things stand on
/// that part of the table that the arm reaches. Fails where nothing was learnt.
Expected<ShownTrial> show_task(const model::HandModel& hand, const model::Catalogue& catalogue,
                               int steps, std::uint64_t seed, bool by_arm = false);

}  // namespace prehend::demonstration
