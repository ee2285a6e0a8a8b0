#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/service/shell.hpp"
#include "common/tasks/task_model.hpp"
#include "services/performer/core/reproduction/task_performer.hpp"

namespace prehend::performer {

struct PerformingOptions {
  bool only_rehearse = false;  // moves nothing
  /// Told what goes on, in a few words.
  std::function<void(const std::string& line)> tell = [](const std::string&) {};
};

/// What came of a task.
struct Performed {
  std::string hand;  // its kind
  bool done = false;
  std::string reason;  // why it is not done
  std::vector<Verdict> verdicts;
  double seconds = 0;  // that the robot took
  bool moved = false;  // the robot was told something
};

/// Does tasks with the robot hand of the lab, one at a time: looks where objects stand
/// (object/state), rehearses, then commands through robot/command and tells task/progress. In the
/// thread of the shell, which must outlive it.
class Performer {
 public:
  /// Fails where the catalogue, the taxonomy or the arm cannot be used.
  static Expected<std::unique_ptr<Performer>> create(service::Shell& shell);
  ~Performer();

  /// What came of it, or why nothing was moved: the hand, an object or the lead is missing, or no
  /// rehearsed grasp does it.
  using OnEnd = std::function<void(const Expected<Performed>&)>;
  /// Begins. Fails while another task is being done.
  Expected<void> begin(tasks::TaskModel task, const PerformingOptions& options, OnEnd on_end);
  /// Ends what it does, for this reason; the hand stays where it is.
  void stop(const std::string& reason);
  /// The task that is being done; nullptr: none.
  const tasks::TaskModel* task() const;
  /// The robot hand is being moved.
  bool moves() const;

 private:
  class State;
  explicit Performer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::performer
