#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/carrying/carrying_arm.hpp"
#include "common/grasping/world.hpp"
#include "services/performer/core/rehearsal/candidates.hpp"
#include "services/performer/core/reproduction/task_performer.hpp"

namespace prehend::performer {

/// An object on the table.
struct Thing {
  grasping::Body body;
  Pose X_WO = Pose::Identity();
  std::vector<model::GraspCandidate> planned = {};  // for it, by prehend-planner
};

struct RehearsalOptions {
  /// Of each step; what is planned does not count, nor does a grasp to which the arm has no way.
  int max_tries = 24;
  PerformerOptions performer;            // how the hand goes
  VerdictOptions verdict;                // what counts as done
  std::optional<planning::Robot> robot;  // an arm that carries the hand; none: it flies
  arm::Joints posture;                   // of that arm
  /// Told before each try: which step of the task, which try of it, both from 0.
  std::function<void(std::size_t step, int attempt)> tell = [](std::size_t, int) {};
};

/// How a task went in a world of thought.
struct Rehearsal {
  std::vector<RobotGrasp> grasps;  // of each step
  std::vector<Verdict> verdicts;   // of each step
};

/// Tries a task in a world of its own, with planned grasps first and then with its own, until each
/// step is done, and so finds grasps that hold, are reachable and move nothing else. Fails, naming
/// the step, where none does.
Expected<Rehearsal> rehearse(const model::HandModel& hand, const tasks::TaskModel& task,
                             const std::vector<Thing>& things, const HandGoal& from,
                             const RehearsalOptions& options = {});

/// Lets a performer move the hand of a world, which an arm may carry, until it is over, at most so
/// long, s.
Expected<void> perform_in(grasping::World& world, TaskPerformer& performer, double longest,
                          carrying::CarryingArm* arm = nullptr);

/// The arm of a robot, for a world; at rest in this posture.
Expected<std::unique_ptr<carrying::CarryingArm>> arm_of(const planning::Robot& robot,
                                                        const arm::Joints& posture);

/// Places and shapes of things, by name.
Places places_of(const grasping::World& world);
Shapes shapes_of(const std::vector<Thing>& things);

}  // namespace prehend::performer
