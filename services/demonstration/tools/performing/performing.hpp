#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"
#include "services/demonstration/core/reproduction/task_performer.hpp"
#include "services/demonstration/core/tasks/task_model.hpp"

namespace prehend::demonstration {

struct PerformingOptions {
  bool only_rehearse = false;  // moves nothing
  /// Told what goes on, in a few words.
  std::function<void(const std::string& line)> tell = [](const std::string&) {};
};

/// What came of it.
struct Performed {
  std::string hand;  // its kind
  bool done = false;
  std::string reason;  // why it is not done
  std::vector<Verdict> verdicts;
  double seconds = 0;  // that the robot took
  bool moved = false;  // the robot was told something
};

/// Does a task with the robot hand of the lab: looks where objects stand (object/state), rehearses,
/// then commands through robot/command and tells task/progress. Runs the shell. Fails, and moves
/// nothing, where the hand, an object or the lead is missing, and where no rehearsed grasp does it.
Expected<Performed> perform(service::Shell& shell, const TaskModel& task,
                            const PerformingOptions& options);

}  // namespace prehend::demonstration
