#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/arguments.hpp"
#include "common/stage/arm.hpp"
#include "common/stage/stage.hpp"
#include "common/tasks/task_model.hpp"

namespace prehend::performer {

struct TaskPlayOptions {
  service::LabArguments lab;            // configuration, overrides and domain
  std::string task = "pick-and-place";  // or a file NAME.task, which needs not be shown
  std::string object = "Talc", hand;    // empty: the lab's
  std::string arm;                      // that carries the hand; empty: the lab's, mostly none
  std::uint64_t seed = 1;               // of scene and person
  double timeout = 120;                 // s, for all of it
  bool keep = false;                    // scenes, tasks and logs
  stage::Progress tell = [](const std::string&) {};
};

/// What a demonstration of demonstrations came to.
struct TaskPlayOutcome {
  struct Phase {
    std::string name, object;
    double begin = 0, end = 0;  // s since the first one began
  };
  struct Grasp {
    int contacts = 0;
    double epsilon = -1, volume = 0;
    bool force_closure = false, held = false;
  };
  struct Step {
    std::string object, reason;
    bool done = false;
    double error = 0, turn = 0;  // m, rad
  };
  tasks::TaskModel task;      // as it was understood
  std::vector<Phase> phases;  // that were seen
  std::string hand, grasp_type;
  std::uint64_t frames = 0;
  std::optional<double> place_error;  // m, of where the object was seen to be put; if it was shown
  std::optional<stage::ArmUse> arm;   // that carried the hand
  std::optional<Grasp> grasp;         // as the simulation judged it
  bool done = false;
  std::string reason;
  std::vector<Step> steps;
};

/// A person who does not exist shows a task to a lab of real processes; the lab learns it;
/// everything is moved elsewhere, and a simulated robot hand does it again and is judged.
Expected<TaskPlayOutcome> play_task(const TaskPlayOptions& options);

}  // namespace prehend::performer
