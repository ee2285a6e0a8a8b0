#include "services/performer/core/reproduction/step_performer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/tasks/task_model.hpp"

namespace prehend::performer {

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double arrived_at = 0.006, arrived_turn = 0.04;  // m, rad
constexpr double stands_for = 0.3;   // s, that fingers stand when they have closed
constexpr double opened = 0.05;      // rad
constexpr double above = 0.002;      // m, over its place that an object is let go
constexpr double toppled = 0.3;      // rad
constexpr double raised_by = 0.003;  // m, of an object by the fingers that close on it

Pose at_height(const Pose& X, double z) {
  Pose made = X;
  made.translation().z() = z;
  return made;
}

}  // namespace

std::string_view to_string(StepPart part) {
  constexpr std::array<std::string_view, part_count> names{"approach", "close",   "lift",   "carry",
                                                           "put down", "release", "retract"};
  return names.at(static_cast<std::size_t>(part));
}

StepPerformer::StepPerformer(const model::HandModel& hand, StepOrder order, HandGoal from,
                             const PerformerOptions& options, Pilot pilot)
    : hand_(hand),
      order_(std::move(order)),
      options_(options),
      pilot_(std::move(pilot)),
      goal_(std::move(from)) {}

/// Against the direction in which the hand comes.
Pose StepPerformer::back(const Pose& X_WB, double by) const {
  Pose made = X_WB;
  made.pretranslate(-by * (X_WB * hand_.X_BG()).linear().col(2));
  return made;
}

Pose StepPerformer::raised(const Pose& X_WB) const {
  return at_height(X_WB, std::max(order_.travel, X_WB.translation().z()));
}

/// What drives each DoF: the joint that is farthest closed of those that follow it, since a clutch
/// may have let go of one.
VectorXd StepPerformer::motors(const RobotNow& robot) const {
  VectorXd made = robot.dof;
  for (std::size_t j = 0; j < hand_.joints().size(); ++j) {
    const model::HandJoint& joint = hand_.joints()[j];
    const auto d = static_cast<Eigen::Index>(joint.dof);
    const int closing = hand_.dofs()[static_cast<std::size_t>(joint.dof)].closing;
    if (closing == 0 || joint.multiplier == 0) continue;
    const double motor =
        (robot.joint[static_cast<Eigen::Index>(j)] - joint.offset) / joint.multiplier;
    made[d] = closing > 0 ? std::max(made[d], motor) : std::min(made[d], motor);
  }
  return made;
}

void StepPerformer::go(std::vector<Pose> poses, double speed, const RobotNow& robot) {
  poses.insert(poses.begin(), goal_.X_WB);
  way_ = Way(std::move(poses), speed, options_.turn_speed);
  since_ = robot.stamp;
}

double StepPerformer::high() const {
  return std::max(X_WO_before_.translation().z(), order_.X_WO_goal.translation().z()) +
         std::max(order_.via_height, options_.min_lift);
}

bool StepPerformer::travel(const Pose& to, std::vector<Pose> then, std::size_t straight,
                           const RobotNow& robot, const Pose& X_WO) {
  const bool held = part_ == StepPart::carry;
  const auto way =
      pilot_({robot.arm, to, then, goal_.dof, order_.object, X_WO, held, order_.upright});
  if (!way) {
    failure_ = way.error().what;
    failed_part_ = part_;
    return false;
  }
  then.resize(straight);
  then.insert(then.begin(), to);
  way_ = way->then(Way(std::move(then), options_.speed, options_.turn_speed));
  since_ = robot.stamp;
  return true;
}

void StepPerformer::approach(const RobotNow& robot, const Pose& X_WO) {
  const Pose X_WB = X_WO * order_.grasp.X_OB, before = back(X_WB, options_.stand_off);
  X_WO_before_ = X_WO;
  goal_.dof = order_.grasp.preshape;
  // From an object that it stood around, the hand goes the way it came.
  const Pose away = tries_ > 0 ? back(goal_.X_WB, options_.stand_off) : goal_.X_WB;
  if (!pilot_) return go({away, raised(away), raised(before), before, X_WB}, options_.speed, robot);
  // An arm that could not lift there needs not go there.
  const Pose lifted = at_height(X_WB, X_WB.translation().z() + high() - X_WO.translation().z());
  over_ = !travel(before, {X_WB, lifted}, 1, robot, X_WO);
}

void StepPerformer::carry(const RobotNow& robot, const Pose& X_WO) {
  X_BO_ = robot.X_WB.inverse() * X_WO;
  const Pose X_OB = X_BO_.inverse(), over = at_height(order_.X_WO_goal, high()) * X_OB;
  if (!pilot_) return go({over}, options_.speed, robot);
  const Pose down = order_.X_WO_goal * X_OB;
  if (travel(over, {down, back(down, options_.stand_off)}, 0, robot, X_WO)) return;
  // Back to where the hand took it: the arm has been there.
  order_.X_WO_goal = X_WB_gripped_ * X_BO_;
  enter(StepPart::put_down, robot, X_WO);
}

void StepPerformer::enter(StepPart part, const RobotNow& robot, const Pose& X_WO) {
  part_ = part;
  since_ = robot.stamp;
  switch (part) {
    case StepPart::approach:
      return approach(robot, X_WO);
    case StepPart::release:
      goal_.dof = hand_.clamp(motors(robot));
      return;
    case StepPart::close:
      still_since_ = robot.stamp;
      stood_ = motors(robot);
      return;
    case StepPart::lift:
      X_WB_gripped_ = goal_.X_WB;
      return go({at_height(goal_.X_WB,
                           goal_.X_WB.translation().z() + high() - X_WO_before_.translation().z())},
                options_.careful, robot);
    case StepPart::carry:
      return carry(robot, X_WO);
    case StepPart::put_down:
      X_BO_ = robot.X_WB.inverse() * X_WO;
      return go({at_height(order_.X_WO_goal, order_.X_WO_goal.translation().z() + above) *
                 X_BO_.inverse()},
                options_.careful, robot);
    case StepPart::retract: {
      const Pose away = back(goal_.X_WB, options_.stand_off);
      if (pilot_) return go({away}, options_.speed, robot);
      return go({away, raised(away)}, options_.speed, robot);
    }
  }
}

bool StepPerformer::try_again(const RobotNow& robot, const Pose& X_WO) {
  if (tries_ >= options_.retries || tasks::tilt(X_WO) > tasks::tilt(X_WO_before_) + toppled)
    return false;
  ++tries_;
  again_ = true;
  enter(StepPart::release, robot, X_WO);
  return true;
}

void StepPerformer::give_up(const std::string& why, const RobotNow& robot, const Pose& X_WO) {
  if ((part_ == StepPart::close || part_ == StepPart::lift) && try_again(robot, X_WO)) return;
  failure_ = why;
  failed_part_ = part_;
  enter(StepPart::release, robot, X_WO);
}

void StepPerformer::next(const RobotNow& robot, const Pose& X_WO) {
  if (part_ == StepPart::retract) {
    if (std::exchange(again_, false)) return enter(StepPart::approach, robot, X_WO);
    over_ = true;
    return;
  }
  const Vector3d moved = X_WO.translation() - X_WO_before_.translation();
  if (part_ == StepPart::close && moved.head<2>().norm() > options_.pushed &&
      try_again(robot, X_WO))
    return;
  // An arm plans its way from where the hand is clear of the object.
  if (part_ == StepPart::release && again_ && pilot_) return enter(StepPart::retract, robot, X_WO);
  if (part_ == StepPart::release && std::exchange(again_, false))
    return enter(StepPart::approach, robot, X_WO);
  enter(static_cast<StepPart>(static_cast<int>(part_) + 1), robot, X_WO);
}

void StepPerformer::follow(const RobotNow& robot, const Pose& X_WO) {
  const double t = to_seconds(robot.stamp - since_);
  goal_.X_WB = way_.at(t);
  if (part_ == StepPart::lift || part_ == StepPart::carry || part_ == StepPart::put_down)
    max_tilt_ = std::max(max_tilt_, tasks::tilt(X_WO));
  if ((part_ == StepPart::carry || part_ == StepPart::put_down) &&
      (robot.X_WB.inverse() * X_WO * X_BO_.inverse()).translation().norm() > options_.lost)
    return give_up("was lost on the way", robot, X_WO);
  if (t < way_.duration()) return;
  const bool arrived = (robot.X_WB.translation() - goal_.X_WB.translation()).norm() < arrived_at &&
                       angle_between(robot.X_WB.linear(), goal_.X_WB.linear()) < arrived_turn;
  if (!arrived) {
    if (t < way_.duration() + options_.patience) return;
    if (!failure_) failed_part_ = part_;
    if (!failure_) failure_ = "the hand does not get where it is told";
    over_ = true;
    return;
  }
  const double lifted = goal_.X_WB.translation().z() - way_.at(0).translation().z();
  if (part_ == StepPart::lift &&
      X_WO.translation().z() - X_WO_before_.translation().z() < lifted - options_.lost)
    return give_up("was not lifted", robot, X_WO);
  next(robot, X_WO);
}

VectorXd StepPerformer::closing_speeds() const {
  const VectorXd& way = order_.grasp.closing;
  VectorXd speeds = VectorXd::Zero(goal_.dof.size());
  double longest = 0;  // rad, or what stands for it
  for (Eigen::Index i = 0; i < speeds.size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(i)];
    speeds[i] = way.size() == 0 ? dof.closing * model::radian_of(dof) : way[i];
    longest = std::max(longest, std::abs(speeds[i]) / model::radian_of(dof));
  }
  return longest > 0 ? (options_.finger_speed / longest * speeds).eval() : speeds;
}

/// Ahead of the motors until all have stood for a while; then so far past them that drives give all
/// they have.
void StepPerformer::close(const RobotNow& robot, const Pose& X_WO) {
  const double dt = to_seconds(robot.stamp - last_);
  const VectorXd now = motors(robot), speeds = closing_speeds();
  bool moves = false;
  for (Eigen::Index i = 0; i < now.size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(i)];
    if (speeds[i] == 0) continue;
    const double step = speeds[i] * dt;
    const double most = now[i] + std::copysign(dof.squeeze, speeds[i]);
    goal_.dof[i] =
        speeds[i] > 0 ? std::min(goal_.dof[i] + step, most) : std::max(goal_.dof[i] + step, most);
    moves |= std::abs(now[i] - stood_[i]) > options_.still * stands_for * model::radian_of(dof);
  }
  goal_.dof = hand_.clamp(goal_.dof);
  const double t = to_seconds(robot.stamp - since_);
  if (moves) {
    stood_ = now;
    still_since_ = robot.stamp;
  }
  // What fingers raise they have: they would go on to pull it up, and turn it.
  if (X_WO.translation().z() - X_WO_before_.translation().z() > raised_by) return next(robot, X_WO);
  // The command must have come to its squeeze.
  if (t > 2 * stands_for && to_seconds(robot.stamp - still_since_) > stands_for)
    return next(robot, X_WO);
  if (t > 4 * options_.patience) give_up("fingers do not come to rest", robot, X_WO);
}

/// What presses lets go as fast as it can, all at once: a finger that does so last would push the
/// object away, and links that uncurl slowly would carry it along.
void StepPerformer::open(const RobotNow& robot, const Pose& X_WO) {
  const double dt = to_seconds(robot.stamp - last_);
  bool there = true;
  for (Eigen::Index i = 0; i < goal_.dof.size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(i)];
    const bool presses = dof.closing * (goal_.dof[i] - robot.dof[i]) > 0;
    const double step =
        (presses ? dof.max_velocity : options_.finger_speed * model::radian_of(dof)) * dt;
    const double way = order_.grasp.preshape[i] - goal_.dof[i];
    goal_.dof[i] += std::clamp(way, -step, step);
    there &= std::abs(robot.dof[i] - order_.grasp.preshape[i]) < opened * model::radian_of(dof);
  }
  const double t = to_seconds(robot.stamp - since_);
  if (there || t > 2 * options_.patience) next(robot, X_WO);
}

HandGoal StepPerformer::step(const RobotNow& robot, const Pose& X_WO) {
  if (over_) return goal_;
  if (!begun_) {
    begun_ = true;
    last_ = robot.stamp;
    enter(StepPart::approach, robot, X_WO);
    if (over_) return goal_;  // an arm cannot get there
  }
  if (part_ == StepPart::close)
    close(robot, X_WO);
  else if (part_ == StepPart::release)
    open(robot, X_WO);
  else
    follow(robot, X_WO);
  last_ = robot.stamp;
  return goal_;
}

}  // namespace prehend::performer
