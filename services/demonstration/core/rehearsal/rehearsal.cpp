#include "services/demonstration/core/rehearsal/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/placement.hpp"

namespace prehend::demonstration {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr int steps_a_command = 5;    // 100 Hz, as robot/state
constexpr double max_step_time = 60;  // s
constexpr int more_tries = 2;         // once one grasp has done it, for a better one
constexpr double sure = 0.5;          // of what is permitted: no other grasp needs to be tried
constexpr const char* out_of_reach = "approach";      // of a grasp that could not even be tried
constexpr double same_place = 0.01, same_turn = 0.1;  // m, rad: no other grasp

Pose turned(double degrees, const Pose& X_OG) {
  const AngleAxisd turn(degrees * std::numbers::pi / 180, Vector3d::UnitZ());
  return Pose(turn) * X_OG;
}

/// One step as a task of its own.
TaskModel alone(const TaskModel& task, std::size_t step) {
  TaskModel made{task.name, task.demonstrations, {task.steps[step]}};
  made.steps.front().after.clear();
  return made;
}

/// How much of what is permitted a verdict uses, of the worst; the world is never as it was
/// thought.
double used(const Verdict& verdict, const Step& step, const VerdictOptions& limits) {
  const double tilt = step.upright ? verdict.max_tilt / limits.max_tilt : 0;
  return std::max({verdict.error / limits.max_error, verdict.turn / limits.max_turn, tilt});
}

/// A step that was done in a copy of a world.
struct Trial {
  std::unique_ptr<grasping::World> world;
  RobotGrasp grasp;
  Verdict verdict;
  arm::Joints posture;  // of the arm, at the end
};

/// One step, in a copy of the world. Fails if it cannot be tried, or is not done.
Expected<Trial> try_step(const model::HandModel& hand, const TaskModel& task,
                         const grasping::World& before, const Shapes& shapes,
                         const RobotGrasp& grasp, const RehearsalOptions& options) {
  Trial made{before.clone(), grasp, {}, options.posture};
  std::unique_ptr<carrying::CarryingArm> arm;
  if (options.robot) {
    auto carried = arm_of(*options.robot, options.posture);
    if (!carried) return tl::unexpected(carried.error());
    arm = std::move(*carried);
  }
  auto performer =
      TaskPerformer::create(hand, task, shapes, places_of(*made.world), {grasp},
                            {made.world->commanded_base(), made.world->commanded_dof()},
                            options.performer, options.verdict, {options.robot, false, true});
  if (!performer) return tl::unexpected(performer.error());
  if (auto ok = perform_in(*made.world, *performer, max_step_time, arm.get()); !ok)
    return tl::unexpected(ok.error());
  if (arm) made.posture = arm->posture();
  made.verdict = performer->verdicts().front();
  if (!made.verdict.done)
    return fail(made.verdict.reason, made.verdict.reached ? "" : out_of_reach);
  return made;
}

/// The same grasps turned half about the approach: another posture of an arm, and for most hands
/// as good.
void add_rolled(const model::HandModel& hand, std::vector<RobotGrasp>& grasps) {
  const Pose roll(AngleAxisd(std::numbers::pi, Vector3d::UnitZ()));
  for (std::size_t i = 0, count = grasps.size(); i < count; ++i) {
    RobotGrasp rolled = grasps[i];
    rolled.X_OB = rolled.X_OB * hand.X_BG() * roll * hand.X_BG().inverse();
    grasps.push_back(std::move(rolled));
  }
}

/// The first grasp that does a step and leaves room for what may be otherwise, or else the one that
/// leaves most.
Expected<Trial> best_trial(const model::HandModel& hand, const TaskModel& task,
                           const grasping::World& before, const Shapes& shapes,
                           const RehearsalOptions& options, const std::function<void(int)>& tell) {
  const Step& step = task.steps.front();
  auto candidates = grasp_candidates(hand, shapes.at(step.object), step.X_OG);
  if (options.robot) add_rolled(hand, candidates);
  int left = more_tries, tries = 0;
  Expected<Trial> best = fail("the hand cannot reach around it");
  for (std::size_t k = 0; k < candidates.size() && tries < options.max_tries && left >= 0; ++k) {
    tell(static_cast<int>(k));
    auto trial = try_step(hand, task, before, shapes, candidates[k], options);
    const bool is_tried = trial || trial.error().where != out_of_reach;
    tries += is_tried;
    if (!is_tried && tries > 0) continue;
    const bool better =
        trial && best &&
        used(trial->verdict, step, options.verdict) < used(best->verdict, step, options.verdict);
    if (!best || better) best = std::move(trial);
    if (!best) continue;
    if (used(best->verdict, step, options.verdict) <= sure) break;
    --left;
  }
  return best;
}

}  // namespace

std::vector<RobotGrasp> grasp_candidates(const model::HandModel& hand, const model::Shape& shape,
                                         const Pose& X_OG) {
  std::vector<Pose> found;
  const auto offer = [&](const Pose& wanted) {
    const auto made = model::nearest_grasp(shape, wanted, hand.reach());
    if (!made || std::any_of(found.begin(), found.end(), [&](const Pose& other) {
          return (other.translation() - made->translation()).norm() < same_place &&
                 angle_between(other.linear(), made->linear()) < same_turn;
        }))
      return;
    found.push_back(*made);
  };
  offer(X_OG);
  for (const double turn : {30, -30, 60, -60, 90, -90, 180}) offer(turned(turn, X_OG));
  const Vector3d y = X_OG.linear().col(1);
  const Vector3d closing = Vector3d(y.x(), y.y(), 0).norm() > 1e-6
                               ? Vector3d(y.x(), y.y(), 0).normalized()
                               : Vector3d::UnitX().eval();
  const Pose above = make_pose(Vector3d::Zero(), model::grasp_axes(-Vector3d::UnitZ(), closing));
  for (const double turn : {0, 90, 45, -45, 180, -90, 135, -135}) offer(turned(turn, above));
  std::vector<RobotGrasp> made;
  for (const Pose& X : found)
    made.push_back({X * hand.X_BG().inverse(), hand.postures().at("open")});
  return made;
}

Places places_of(const grasping::World& world) {
  Places made;
  for (int i = 0; i < world.body_count(); ++i) made[world.body(i).name] = world.body_motion(i).X_WO;
  return made;
}

Shapes shapes_of(const std::vector<Thing>& things) {
  Shapes made;
  for (const Thing& thing : things) made[thing.body.name] = thing.body.shape;
  return made;
}

Expected<std::unique_ptr<carrying::CarryingArm>> arm_of(const planning::Robot& robot,
                                                        const arm::Joints& posture) {
  auto made = carrying::CarryingArm::create(*robot.arm, *robot.hand, robot.X_WA, robot.X_EB);
  if (made) (*made)->start(posture);
  return made;
}

Expected<void> perform_in(grasping::World& world, TaskPerformer& performer, double longest,
                          carrying::CarryingArm* arm) {
  for (int n = 0; !performer.over(); ++n) {
    const double t = n * steps_a_command * world.time_step();
    if (t > longest) return fail("takes longer than it should");
    const grasping::HandMotion motion = world.hand_motion();
    const HandGoal goal = performer.step({Time(seconds(t)), motion.X_WB, motion.dof, motion.joint,
                                          arm ? arm->posture() : arm::Joints()},
                                         places_of(world));
    if (auto told = world.command(goal.X_WB, goal.dof); !told) return told;
    if (arm) arm->follow(goal.X_WB);
    for (int i = 0; i < steps_a_command; ++i) {
      if (arm) arm->step(world);
      world.step();
    }
  }
  return {};
}

Expected<Rehearsal> rehearse(const model::HandModel& hand, const TaskModel& task,
                             const std::vector<Thing>& things, const HandGoal& from,
                             const RehearsalOptions& given) {
  RehearsalOptions options = given;
  const auto order = order_of(task);
  if (!order) return tl::unexpected(order.error());
  auto created = grasping::World::create(hand, from.X_WB, from.dof);
  if (!created) return tl::unexpected(created.error());
  std::unique_ptr<grasping::World> world = std::move(*created);
  for (const Thing& thing : things)
    if (auto added = world->add_body(thing.body, thing.X_WO); !added)
      return tl::unexpected(added.error());
  const Shapes shapes = shapes_of(things);
  Rehearsal made{std::vector<RobotGrasp>(task.steps.size()),
                 std::vector<Verdict>(task.steps.size())};
  for (const std::size_t i : *order) {
    const Step& step = task.steps[i];
    if (!shapes.contains(step.object))
      return fail("is not in this lab", step.object, "the task " + task.name + " needs it");
    if (step.reference != the_table && !shapes.contains(step.reference))
      return fail("is not in this lab", step.reference, "the task " + task.name + " needs it");
    auto best = best_trial(hand, alone(task, i), *world, shapes, options,
                           [&](int attempt) { options.tell(i, attempt); });
    if (!best)
      return fail("no grasp does step " + std::to_string(i + 1) + " of " + task.name + ": " +
                      best.error().what,
                  step.object, "place the objects otherwise, or show another grasp");
    world = std::move(best->world);
    made.grasps[i] = best->grasp;
    made.verdicts[i] = best->verdict;
    options.posture = best->posture;
  }
  return made;
}

}  // namespace prehend::demonstration
