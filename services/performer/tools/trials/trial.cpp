#include "services/performer/tools/trials/trial.hpp"

#include <algorithm>

#include "common/base/random.hpp"

namespace prehend::performer {

namespace {

constexpr double world_noise = 0.001, world_turn = 0.0175;  // m, rad
constexpr double longest = 120;                             // s, of a task

/// Where things truly stand.
std::vector<Thing> disturbed(std::vector<Thing> things, Random& random) {
  for (Thing& thing : things) {
    const Eigen::AngleAxisd turn(random.normal(world_turn), Eigen::Vector3d::UnitZ());
    Eigen::Vector3d shift = random.normal3(world_noise);
    shift.z() = 0;
    thing.X_WO = make_pose(thing.X_WO.translation() + shift, turn * thing.X_WO.linear());
  }
  return things;
}

}  // namespace

TaskTrial try_task(const model::HandModel& hand, const tasks::TaskModel& task,
                   const std::vector<Thing>& things, std::uint64_t seed,
                   const std::optional<planning::Robot>& robot) {
  TaskTrial trial;
  HandGoal from{make_pose({0, -0.4, 0.6}), hand.postures().at("open")};
  std::unique_ptr<carrying::CarryingArm> arm;
  RehearsalOptions how;
  if (robot) {
    how.robot = robot;
    how.posture = robot->arm->home;
    auto made = arm_of(*robot, robot->arm->home);
    if (!made) {
      trial.reason = made.error().message();
      return trial;
    }
    arm = std::move(*made);
    from.X_WB = arm->home();
  }
  const auto rehearsed = rehearse(hand, task, things, from, how);
  if (!rehearsed) {
    trial.reason = rehearsed.error().message();
    return trial;
  }
  trial.rehearsed = true;
  trial.planned = static_cast<int>(std::count_if(rehearsed->grasps.begin(), rehearsed->grasps.end(),
                                                 [](const auto& grasp) { return grasp.planned; }));
  Random random(seed * 31 + 7);
  const std::vector<Thing> truth = disturbed(things, random);
  grasping::WorldOptions physics;
  if (arm) physics.base = carrying::CarryingArm::base();
  auto world = grasping::World::create(hand, from.X_WB, from.dof, physics);
  if (!world) return trial;
  for (const Thing& thing : truth) (*world)->add_body(thing.body, thing.X_WO);
  auto performer = TaskPerformer::create(hand, task, shapes_of(things), places_of(**world),
                                         rehearsed->grasps, from, {}, {}, {robot});
  if (!performer) {
    trial.reason = performer.error().message();
    return trial;
  }
  if (const auto performed = perform_in(**world, *performer, longest, arm.get()); !performed) {
    trial.reason = performed.error().message();
    return trial;
  }
  trial.done = performer->done();
  trial.reason = performer->reason();
  for (const Verdict& verdict : performer->verdicts()) {
    trial.max_error = std::max(trial.max_error, verdict.error);
    trial.max_turn = std::max(trial.max_turn, verdict.turn);
  }
  return trial;
}

}  // namespace prehend::performer
