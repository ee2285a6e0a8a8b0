#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/demonstration/core/recognition/recogniser.hpp"
#include "services/demonstration/tools/evaluation/judged.hpp"
#include "services/demonstration/tools/training/trainer.hpp"

namespace prehend::demonstration {

/// What came of one task.
struct TaskResult {
  std::string task;
  std::vector<std::string> classes;
  std::map<Method, std::vector<Judged>> methods;
  std::map<Method, std::vector<Judged>> with_object;  // the same takes, where the object is known
  std::optional<Error> trouble;                       // why there are no answers
  std::vector<std::string> not_learnt{};              // kinds that nobody taught: always wrong
};

/// Takes by task, in order of name.
std::map<std::string, std::vector<const Take*>> by_task(const std::vector<Take>& takes);

/// Each task by itself: every person's takes are judged by recognisers that were trained on all
/// others; with `training`, by those that were trained on it. A kind of grasp that nobody trained
/// is answered wrongly. `threads`: 0 for all cores. progress: recognisers done, of how many.
/// with_object: also says what is answered once the object is known, as far as takes say it.
std::vector<TaskResult> judge(const std::vector<Take>& takes, const std::vector<Take>* training,
                              const TrainerOptions& options, unsigned threads,
                              const std::function<void(std::size_t, std::size_t)>& progress,
                              bool with_object = false);

/// By recognisers that are there already, of one task.
TaskResult judge_with(const std::string& task, const std::vector<const Take*>& takes,
                      const std::vector<Recogniser>& recognisers);

}  // namespace prehend::demonstration
