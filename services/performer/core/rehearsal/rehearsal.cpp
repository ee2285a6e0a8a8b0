#include "services/performer/core/rehearsal/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace prehend::performer {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr int steps_a_command = 5;    // 100 Hz, as robot/state
constexpr double max_step_time = 60;  // s
// Of what is permitted. A sure grasp ends the search; one that will do, after so many more.
constexpr double sure = 0.25, will_do = 0.4;
constexpr int more_tries = 2;
constexpr const char* out_of_reach = "approach";  // of a grasp that could not even be tried
constexpr double beside = 0.003, aslant = 0.035;  // m, rad (2°), that a hand may stand off

/// One step as a task of its own.
tasks::TaskModel alone(const tasks::TaskModel& task, std::size_t step) {
  tasks::TaskModel made{task.name, task.demonstrations, {task.steps[step]}};
  made.steps.front().after.clear();
  return made;
}

/// A step that was tried in a copy of a world.
struct Trial {
  std::unique_ptr<grasping::World> world;
  RobotGrasp grasp;
  Verdict verdict;
  arm::Joints posture;  // of the arm, at the end
};

/// How much of what is permitted a trial uses, of the worst; the world is never as it was thought.
double used(const Trial& trial, const tasks::Step& step, const VerdictOptions& limits) {
  const Verdict& verdict = trial.verdict;
  if (!verdict.done) return std::numeric_limits<double>::infinity();
  const double tilt = step.upright ? verdict.max_tilt / limits.max_tilt : 0;
  return std::max(
      {verdict.error / limits.max_error, verdict.turn / limits.max_turn, tilt, verdict.others});
}

/// One step, in a copy of the world. Fails if it cannot be tried.
Expected<Trial> try_step(const model::HandModel& hand, const tasks::TaskModel& task,
                         const grasping::World& before, const Shapes& shapes,
                         const RobotGrasp& grasp, const RehearsalOptions& options) {
  Trial made{before.clone(), grasp, {}, options.posture};
  std::unique_ptr<carrying::CarryingArm> arm;
  if (options.robot) {
    auto carried = arm_of(*options.robot, options.posture);
    if (!carried) return tl::unexpected(carried.error());
    arm = std::move(*carried);
  }
  PerformerOptions once = options.performer;
  once.retries = 0;  // a grasp that does it at the first attempt is looked for
  auto performer =
      TaskPerformer::create(hand, task, shapes, places_of(*made.world), {grasp},
                            {made.world->commanded_base(), made.world->commanded_dof()}, once,
                            options.verdict, {options.robot, false, true});
  if (!performer) return tl::unexpected(performer.error());
  if (auto ok = perform_in(*made.world, *performer, max_step_time, arm.get()); !ok)
    return tl::unexpected(ok.error());
  if (arm) made.posture = arm->posture();
  made.verdict = performer->verdicts().front();
  return made;
}

/// By a hand that stands a little to one side, along its closing direction, and turned.
RobotGrasp disturbed(const model::HandModel& hand, const RobotGrasp& grasp, double side) {
  const Pose X_GG = make_pose({0, side * beside, 0},
                              AngleAxisd(side * aslant, Vector3d::UnitZ()).toRotationMatrix());
  RobotGrasp made = grasp;
  made.X_OB = grasp.X_OB * hand.X_BG() * X_GG * hand.X_BG().inverse();
  return made;
}

/// A grasp that was tried, and how much it uses of what is permitted at worst, if the hand stands
/// as it should or a little beside; infinite: not always done.
struct Tried {
  Trial trial;
  double worst = 0;
};

/// Fails if the step is not done by a hand that stands as it should.
Expected<Tried> try_surely(const model::HandModel& hand, const tasks::TaskModel& task,
                           const grasping::World& before, const Shapes& shapes,
                           const RobotGrasp& grasp, const RehearsalOptions& options) {
  const auto used_by = [&](const Expected<Trial>& trial) {
    return trial ? used(*trial, task.steps.front(), options.verdict)
                 : std::numeric_limits<double>::infinity();
  };
  auto trial = try_step(hand, task, before, shapes, grasp, options);
  if (!trial) return tl::unexpected(trial.error());
  if (!trial->verdict.done)
    return fail(trial->verdict.reason, trial->verdict.reached ? "" : out_of_reach);
  double worst = used_by(trial);
  for (const double side : {1.0, -1.0})
    if (std::isfinite(worst))
      worst = std::max(worst, used_by(try_step(hand, task, before, shapes,
                                               disturbed(hand, grasp, side), options)));
  return Tried{std::move(*trial), worst};
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

/// How this step's object may be taken, the likeliest first: planned grasps have been judged.
std::vector<RobotGrasp> all_grasps(const model::HandModel& hand, const tasks::Step& step,
                                   const std::vector<Thing>& things, bool by_arm) {
  const auto thing = std::find_if(things.begin(), things.end(),
                                  [&](const Thing& each) { return each.body.name == step.object; });
  const model::Shape& shape = thing->body.shape;
  auto all = planned_grasps(hand, shape, step.X_OG, thing->planned);
  auto own = grasp_candidates(hand, shape, step.X_OG);
  if (by_arm) add_rolled(hand, own);
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

/// The first grasp that does a step and leaves room for what may be otherwise, or else the one that
/// leaves most. Fails if none does it.
Expected<Tried> best_trial(const model::HandModel& hand, const tasks::TaskModel& task,
                           const grasping::World& before, const Shapes& shapes,
                           const std::vector<RobotGrasp>& candidates,
                           const RehearsalOptions& options, const std::function<void(int)>& tell) {
  int left = more_tries, tries = 0;
  bool is_any_reached = false;
  Expected<Tried> best = fail("the hand cannot reach around it");
  for (std::size_t k = 0; k < candidates.size() && tries < options.max_tries && left >= 0; ++k) {
    tell(static_cast<int>(k));
    auto tried = try_surely(hand, task, before, shapes, candidates[k], options);
    const bool is_reached = tried || tried.error().where != out_of_reach;
    if (!is_reached && is_any_reached) continue;  // there is something better to say
    is_any_reached |= is_reached;
    tries += is_reached && !candidates[k].planned;
    if (!best || (tried && tried->worst < best->worst)) best = std::move(tried);
    if (!best || best->worst > will_do) continue;
    if (best->worst <= sure) break;
    --left;
  }
  return best;
}

}  // namespace

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

Expected<Rehearsal> rehearse(const model::HandModel& hand, const tasks::TaskModel& task,
                             const std::vector<Thing>& things, const HandGoal& from,
                             const RehearsalOptions& given) {
  RehearsalOptions options = given;
  const auto order = tasks::order_of(task);
  if (!order) return tl::unexpected(order.error());
  // An arm gives way to what the hand touches, in thought as it does live.
  grasping::WorldOptions physics;
  if (options.robot) physics.base = carrying::CarryingArm::base();
  auto created = grasping::World::create(hand, from.X_WB, from.dof, physics);
  if (!created) return tl::unexpected(created.error());
  std::unique_ptr<grasping::World> world = std::move(*created);
  for (const Thing& thing : things)
    if (auto added = world->add_body(thing.body, thing.X_WO); !added)
      return tl::unexpected(added.error());
  const Shapes shapes = shapes_of(things);
  if (auto lacks = lacking(task, [&](const std::string& name) { return shapes.contains(name); }))
    return tl::unexpected(*lacks);
  Rehearsal made{std::vector<RobotGrasp>(task.steps.size()),
                 std::vector<Verdict>(task.steps.size())};
  for (const std::size_t i : *order) {
    const tasks::Step& step = task.steps[i];
    auto best = best_trial(hand, alone(task, i), *world, shapes,
                           all_grasps(hand, step, things, options.robot.has_value()), options,
                           [&](int attempt) { options.tell(i, attempt); });
    if (!best)
      return fail("no grasp does step " + std::to_string(i + 1) + " of " + task.name + ": " +
                      best.error().what,
                  step.object, "place the objects otherwise, or show another grasp");
    world = std::move(best->trial.world);
    made.grasps[i] = best->trial.grasp;
    made.verdicts[i] = best->trial.verdict;
    options.posture = best->trial.posture;
  }
  return made;
}

}  // namespace prehend::performer
