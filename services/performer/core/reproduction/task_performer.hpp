#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/tasks/task_model.hpp"
#include "services/performer/core/reproduction/step_performer.hpp"

namespace prehend::performer {

/// Where objects are, by name; and what shape they have.
using Places = std::map<std::string, Pose>;
using Shapes = std::map<std::string, model::Shape>;

/// What a step must be to count as done.
struct VerdictOptions {
  double max_error = 0.02;         // m, of the object from its place
  double max_turn = 0.1745;        // rad (10°), see visible_turn()
  double max_tilt = 0.2618;        // rad (15°), of what stays upright
  double max_moved = 0.01;         // m, of any other object
  double max_other_turn = 0.1745;  // rad, of any other object
};

struct Verdict {
  std::string object;
  bool done = false;
  double error = 0, turn = 0, max_tilt = 0;  // m, rad, rad
  double others = 0;                         // of what any other object may move, the share it did
  std::string reason;                        // why it is not done
  bool reached = true;                       // the hand has a way to it
  bool planned = false;                      // its grasp was, by prehend-planner
};

/// An arm that carries the hand, and what it looks out for beside the task.
struct ArmOptions {
  std::optional<planning::Robot> robot = std::nullopt;  // none: the hand flies
  bool goes_home = true;                                // once all is over, or has failed
  bool careful = false;                                 // see PilotOptions
};

/// Does a task again, step by step in its order, and judges it. With an arm it goes home in the
/// end, whatever came of it. Keeps a reference to the hand.
class TaskPerformer {
 public:
  /// grasps: of each step of the task. Fails on a task that is not sound, and on objects or
  /// references that are not there.
  static Expected<TaskPerformer> create(const model::HandModel& hand, tasks::TaskModel task,
                                        Shapes shapes, const Places& places,
                                        std::vector<RobotGrasp> grasps, HandGoal from,
                                        const PerformerOptions& options = {},
                                        const VerdictOptions& verdict = {},
                                        const ArmOptions& arm = {});

  /// The next command. Objects of the task that are not seen any more stay where they were.
  HandGoal step(const RobotNow& robot, const Places& places);

  bool over() const { return at_ == order_.size() && !way_home_; }
  /// All steps are done as they should be.
  bool done() const;
  std::size_t current() const;  // step of the task, from 0
  StepPart part() const { return performer_ ? performer_->part() : StepPart::retract; }
  double share() const;  // of the whole, 0 to 1
  /// Of each step of the task; what was not tried says so.
  const std::vector<Verdict>& verdicts() const { return verdicts_; }
  /// Why it is not done: of the first step that failed.
  std::string reason() const;

 private:
  TaskPerformer(const model::HandModel& hand) : hand_(&hand) {}
  void begin();
  void judge();
  void leave(const RobotNow& robot);
  Pilot pilot() const;

  const model::HandModel* hand_;
  tasks::TaskModel task_;
  Shapes shapes_;
  Places places_, before_;  // now; when the step began
  std::vector<RobotGrasp> grasps_;
  PerformerOptions options_;
  VerdictOptions limits_;
  HandGoal goal_;
  std::vector<std::size_t> order_;
  std::size_t at_ = 0;  // in that order
  std::unique_ptr<StepPerformer> performer_;
  std::vector<Pose> demanded_;  // of each step, once it has begun
  std::vector<Verdict> verdicts_;
  Time settled_{};
  ArmOptions arm_;
  std::optional<Way> way_home_;
  Time left_{};  // for home
};

}  // namespace prehend::performer
