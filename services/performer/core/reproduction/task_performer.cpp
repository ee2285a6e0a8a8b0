#include "services/performer/core/reproduction/task_performer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "services/performer/core/reproduction/alike.hpp"

namespace prehend::performer {

namespace {

constexpr double room = 0.30;  // m, of the base above all that stands
constexpr Duration settling = std::chrono::milliseconds(300);  // until a step is judged

double degrees(double angle) {
  return angle * 180 / std::numbers::pi;
}

/// As high as the base goes on its way.
double travel_over(const Places& places, const Shapes& shapes) {
  double top = 0;
  for (const auto& [name, X_WO] : places)
    if (const auto shape = shapes.find(name); shape != shapes.end())
      top = std::max(top, X_WO.translation().z() + model::half_extents(shape->second).maxCoeff());
  return top + room;
}

}  // namespace

Expected<TaskPerformer> TaskPerformer::create(const model::HandModel& hand, tasks::TaskModel task,
                                              Shapes shapes, const Places& places,
                                              std::vector<RobotGrasp> grasps, HandGoal from,
                                              const PerformerOptions& options,
                                              const VerdictOptions& verdict,
                                              const ArmOptions& arm) {
  if (auto ok = check(task); !ok) return tl::unexpected(ok.error());
  auto order = tasks::order_of(task);
  if (!order) return tl::unexpected(order.error());
  if (grasps.size() != task.steps.size()) return fail("needs a grasp for each step", task.name);
  if (auto lacks = lacking(task, [&](const std::string& name) { return places.contains(name); }))
    return tl::unexpected(*lacks);
  for (const tasks::Step& step : task.steps)
    if (!shapes.contains(step.object)) return fail("has no known shape", step.object);
  TaskPerformer made(hand);
  made.verdicts_.resize(task.steps.size());
  made.demanded_.resize(task.steps.size());
  for (std::size_t i = 0; i < task.steps.size(); ++i) {
    made.verdicts_[i].object = task.steps[i].object;
    made.verdicts_[i].reason = "was not tried";
    made.verdicts_[i].planned = grasps[i].planned;
  }
  made.task_ = std::move(task);
  made.shapes_ = std::move(shapes);
  made.places_ = places;
  made.grasps_ = std::move(grasps);
  made.options_ = options;
  made.limits_ = verdict;
  made.arm_ = arm;
  made.goal_ = std::move(from);
  made.order_ = std::move(*order);
  return made;
}

std::size_t TaskPerformer::current() const {
  return order_[std::min(at_, order_.size() - 1)];
}

double TaskPerformer::share() const {
  const double part = performer_ ? static_cast<double>(performer_->part()) / part_count : 0;
  return at_ == order_.size()
             ? 1
             : (static_cast<double>(at_) + part) / static_cast<double>(order_.size());
}

bool TaskPerformer::done() const {
  return at_ == order_.size() && std::all_of(verdicts_.begin(), verdicts_.end(),
                                             [](const Verdict& verdict) { return verdict.done; });
}

std::string TaskPerformer::reason() const {
  for (const std::size_t i : order_)
    if (!verdicts_[i].done)
      return fmt::format("step {}, {}: {}", i + 1, verdicts_[i].object, verdicts_[i].reason);
  return {};
}

void TaskPerformer::begin() {
  const tasks::Step& step = task_.steps[current()];
  before_ = places_;
  const Pose X_WR =
      step.reference == tasks::the_table ? Pose::Identity() : places_.at(step.reference);
  demanded_[current()] =
      nearest_alike(shapes_.at(step.object), X_WR * step.X_RO, places_.at(step.object));
  performer_ = std::make_unique<StepPerformer>(*hand_,
                                               StepOrder{.object = step.object,
                                                         .grasp = grasps_[current()],
                                                         .X_WO_goal = demanded_[current()],
                                                         .via_height = step.via_height,
                                                         .travel = travel_over(places_, shapes_),
                                                         .upright = step.upright},
                                               goal_, options_, pilot());
}

Pilot TaskPerformer::pilot() const {
  if (!arm_.robot) return {};
  return pilot_of(*arm_.robot, shapes_, places_,
                  {options_.speed, options_.turn_speed, arm_.careful});
}

/// An arm goes home, if there is a way; else it stays where it is.
void TaskPerformer::leave(const RobotNow& robot) {
  if (!arm_.robot || !arm_.goes_home || at_ < order_.size()) return;
  const auto way = pilot()({.from = robot.arm,
                            .X_WB = arm_.robot->hand_at(arm_.robot->arm->home),
                            .dof = goal_.dof,
                            .object = {}});
  if (!way) return;
  way_home_ = *way;
  left_ = robot.stamp;
}

void TaskPerformer::judge() {
  const tasks::Step& step = task_.steps[current()];
  const Pose& X_WO = places_.at(step.object);
  const Pose& goal = demanded_[current()];
  Verdict& verdict = verdicts_[current()];
  verdict.error = (X_WO.translation() - goal.translation()).norm();
  verdict.turn = visible_turn(shapes_.at(step.object), X_WO.linear(), goal.linear());
  verdict.max_tilt = performer_->max_tilt();
  verdict.reason.clear();
  verdict.reached = !performer_->failure() || performer_->failed_part() != StepPart::approach;
  if (performer_->failure())
    verdict.reason =
        fmt::format("{}: {}", to_string(performer_->failed_part()), *performer_->failure());
  else if (verdict.error > limits_.max_error)
    verdict.reason = fmt::format("is {:.1f} cm from its place", 100 * verdict.error);
  else if (verdict.turn > limits_.max_turn)
    verdict.reason = fmt::format("is turned by {:.0f}°", degrees(verdict.turn));
  else if (step.upright && verdict.max_tilt > limits_.max_tilt)
    verdict.reason = fmt::format("was tilted by {:.0f}°", degrees(verdict.max_tilt));
  verdict.others = 0;
  for (const auto& [name, X] : before_) {
    if (name == step.object) continue;
    const Pose& now = places_.at(name);
    const double share = std::max((now.translation() - X.translation()).norm() / limits_.max_moved,
                                  angle_between(now.linear(), X.linear()) / limits_.max_other_turn);
    verdict.others = std::max(verdict.others, share);
    if (verdict.reason.empty() && share > 1) verdict.reason = name + " was moved as well";
  }
  verdict.done = verdict.reason.empty();
}

HandGoal TaskPerformer::step(const RobotNow& robot, const Places& places) {
  for (const auto& [name, X_WO] : places) places_[name] = X_WO;
  if (over()) return goal_;
  if (way_home_) {
    const double t = to_seconds(robot.stamp - left_);
    goal_.X_WB = way_home_->at(t);
    if (t > way_home_->duration()) way_home_.reset();
    return goal_;
  }
  if (!performer_) begin();
  if (!performer_->over()) {
    goal_ = performer_->step(robot, places_.at(task_.steps[current()].object));
    settled_ = robot.stamp + settling;
    return goal_;
  }
  if (robot.stamp < settled_) return goal_;
  judge();
  // What comes after would count on this one.
  at_ = verdicts_[current()].done ? at_ + 1 : order_.size();
  performer_.reset();
  leave(robot);
  return goal_;
}

}  // namespace prehend::performer
