#include "services/simulation/core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/base/motion.hpp"

namespace prehend::simulation {
namespace {

using Eigen::Vector3d;

constexpr double far_off = 10;         // m: no hand works there
constexpr double noticed = 0.005;      // m, by which a sighting must differ to move a body
constexpr double noticed_turn = 0.05;  // rad
constexpr double in_hand = 0.005;      // m, of the hand from what it may hold
constexpr int max_bodies = 32;
constexpr Duration look = std::chrono::milliseconds(100);  // at what the hand may knock over
const Duration max_jump = std::chrono::seconds(60);        // of the lockstep clock

/// Behind and above the table's middle, where nothing stands.
const Pose resting_place = make_pose(Vector3d(0, -0.4, 0.6));
constexpr double apart = 0.4;                       // m, of hands that rest
constexpr grasping::BaseBody pushed_base{10, 0.2};  // as an arm's last links: kg, kg m²

bool differ(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm() > noticed ||
         angle_between(a.linear(), b.linear()) > noticed_turn;
}

/// m, of what a shape covers of the table, whichever way it is turned.
double radius(const model::Shape& shape) {
  return model::half_extents(shape).head<2>().norm();
}

/// Objects stand upright on the table; of a sighting only place and turn about z are taken.
Pose standing(const model::Shape& shape, const Pose& X_WO) {
  const Vector3d x = X_WO.linear().col(0);
  const double yaw = std::hypot(x.x(), x.y()) > 1e-6 ? std::atan2(x.y(), x.x()) : 0.0;
  const Vector3d& p = X_WO.translation();
  return make_pose(Vector3d(p.x(), p.y(), model::half_extents(shape).z()),
                   Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix());
}

tl::unexpected<Error> one_hand_alone() {
  return wrong_use("an arm carries one hand alone", "robot.arm, simulation.hands",
                   "leave one of them out");
}

}  // namespace

Expected<std::unique_ptr<Simulation>> Simulation::create(
    const model::HandModel& hand, const Options& options,
    std::unique_ptr<carrying::CarryingArm> arm) {
  grasping::WorldOptions how{.rate = options.rate, .brake = options.brake};
  if (arm) how.base = carrying::CarryingArm::base();
  if (options.push) {
    if (arm) return one_hand_alone();
    how.push = options.push;
    how.base = pushed_base;
  }
  auto world = grasping::World::create(hand, arm ? arm->home() : resting_place,
                                       hand.postures().at("open"), how);
  if (!world) return tl::unexpected(world.error());
  return std::unique_ptr<Simulation>(new Simulation(options, std::move(*world), std::move(arm)));
}

Simulation::Simulation(const Options& options, std::unique_ptr<grasping::World> world,
                       std::unique_ptr<carrying::CarryingArm> arm)
    : options_(options),
      world_(std::move(world)),
      arm_(std::move(arm)),
      period_(seconds(world_->time_step())) {
  lead(0);
}

void Simulation::lead(int hand) {
  const double dt = world_->time_step();
  hands_.push_back(
      {hand, ClosureDetector(dt, hand), TouchSense(world_->hand(hand).links().size(), dt, hand)});
}

Expected<int> Simulation::add_hand(const model::HandModel& hand) {
  if (arm_) return one_hand_alone();
  const auto beside = static_cast<double>(hands_.size()) * apart * Vector3d::UnitX();
  auto added = world_->add_hand(hand, moved(resting_place, beside), hand.postures().at("open"));
  if (added) lead(*added);
  return added;
}

double Simulation::distance_to_hands(int body, double most) const {
  for (const Led& led : hands_)
    most = std::min(most, world_->distance_to_hand(body, most, led.number));
  return most;
}

Expected<void> Simulation::build(const model::Scene& scene,
                                 const grasping::CatalogueBodies& catalogue) {
  for (const model::PlacedObject& placed : scene.objects) {
    const grasping::Body* object = catalogue.find(placed.name);
    if (!object) return fail("is not in the catalogue", placed.name);
    if (auto added = world_->add_body(*object, placed.X_WO); !added)
      return tl::unexpected(added.error());
  }
  stood_.resize(scene.objects.size());
  return {};
}

void Simulation::put_back() {
  looked_ = time_;
  for (std::size_t i = 0; i < stood_.size(); ++i) {
    const int body = static_cast<int>(i);
    const Pose now = world_->body_motion(body).X_WO;
    Stood& stood = stood_[i];
    if (distance_to_hands(body, options_.far_away) < options_.far_away) {
      if (!stood.where) stood.where = now;
      stood.disturbed = true;
    } else if (!stood.disturbed || placed_.contains(world_->body(body).name)) {
      stood = {now, false};
    } else if (!hand_at(world_->body(body), *stood.where)) {  // what rolls leaves it there
      if (differ(now, *stood.where)) world_->move_body(body, *stood.where);
      stood.disturbed = false;
    }
  }
}

Expected<bool> Simulation::see(const grasping::Body& body, const Pose& X_WO) {
  if (!model::is_valid(body.shape)) return fail("has no valid shape", body.name);
  if (!is_finite(X_WO) || X_WO.translation().norm() > far_off)
    return fail("is not on the table", body.name);
  const Pose place = standing(body.shape, X_WO);
  if (const int i = find(body.name); i >= 0) {
    if (differ(world_->body_motion(i).X_WO, place) && !placed_.contains(body.name) &&
        distance_to_hands(i, options_.far_away) >= options_.far_away)
      world_->move_body(i, place);
    return false;
  }
  return add(body, place);
}

Expected<bool> Simulation::add(const grasping::Body& body, const Pose& place) {
  if (world_->body_count() >= max_bodies) return fail("too many objects", body.name);
  if (auto added = world_->add_body(body, place); !added) return tl::unexpected(added.error());
  return true;
}

int Simulation::find(const std::string& name) const {
  for (int i = 0; i < world_->body_count(); ++i)
    if (world_->body(i).name == name) return i;
  return -1;
}

bool Simulation::hand_at(const grasping::Body& body, const Pose& X_WO) const {
  const double top = 2 * model::half_extents(body.shape).z();
  for (const Led& led : hands_) {
    const grasping::HandMotion hand = world_->hand_motion(led.number);
    for (const Pose& X_BL : world_->hand(led.number).link_poses(hand.joint)) {
      const Vector3d p = hand.X_WB * X_BL.translation();
      const double away = (p - X_WO.translation()).head<2>().norm() - radius(body.shape);
      if (away < options_.far_away && p.z() < top + options_.far_away) return true;
    }
  }
  return false;
}

Expected<void> Simulation::is_free(const grasping::Body& body, const Pose& X_WO, int itself) const {
  for (int i = 0; i < world_->body_count(); ++i)
    if (i != itself &&
        (world_->body_motion(i).X_WO.translation() - X_WO.translation()).head<2>().norm() <
            radius(body.shape) + radius(world_->body(i).shape))
      return fail("cannot stand there", body.name, world_->body(i).name + " does");
  if (hand_at(body, X_WO)) return fail("cannot stand there", body.name, "the hand is in the way");
  return {};
}

Expected<bool> Simulation::place(const grasping::Body& body, const Pose& X_WO) {
  if (!is_finite(X_WO) || X_WO.translation().norm() > far_off)
    return fail("is not on the table", body.name);
  const Pose there = standing(body.shape, X_WO);
  const int known = find(body.name);
  if (const auto free = is_free(body, there, known); !free) return tl::unexpected(free.error());
  if (known >= 0 && distance_to_hands(known, in_hand) < in_hand)
    return fail("cannot be taken", body.name, "the hand has it");
  placed_.insert(body.name);
  if (known < 0) return add(body, there);
  world_->move_body(known, there);
  return false;
}

Expected<void> Simulation::accept(const Command& command, Time now, int hand) {
  Led& one = led(hand);
  const model::HandModel& model = world_->hand(hand);
  if (command.model != model.name()) return fail("command for another model");
  if (command.dof.size() != static_cast<Eigen::Index>(model.dofs().size()))
    return fail("command of wrong length");
  if (!command.dof.allFinite() || !is_finite(command.X_WB)) return fail("command not finite");
  if (command.X_WB.translation().norm() > far_off) return fail("command far away");
  if (auto limited = world_->limit_effort(command.effort, hand); !limited)
    return fail("command with impossible efforts", limited.error().where);
  if (!one.command && !arm_) approach(command, hand);
  if (auto taken = world_->command(command.X_WB, command.dof, Vector3d::Zero(), hand); !taken) {
    world_->limit_effort(one.command ? one.command->effort : Eigen::VectorXd(), hand);
    return fail("command outside limits", taken.error().where, taken.error().hint);
  }
  if (arm_) arm_->follow(command.X_WB);
  one.command = command;
  one.accepted = now;
  one.holding = one.braking = false;
  return {};
}

void Simulation::hold(int hand) {
  world_->brake(hand);
  if (arm_) arm_->brake();
  led(hand).holding = led(hand).braking = true;
}

bool Simulation::hold_together(int hand, int other) const {
  std::set<int> own, others;
  for (const grasping::Touch& touch : world_->touches()) {
    if (touch.hand == hand) own.insert(touch.body);
    if (touch.hand == other) others.insert(touch.body);
  }
  return std::any_of(own.begin(), own.end(), [&](int body) {
    return body >= 0 && others.contains(body) && !world_->touches_others(body);
  });
}

/// The base must not come back to where it was when it was told to stay, 5 cm behind at 1 m/s.
void Simulation::brake(Led& led) {
  const Pose before = world_->commanded_base(led.number);
  world_->hold_still(led.number);
  if (arm_) {
    led.braking = !arm_->rests();
    return;
  }
  const Pose& now = world_->commanded_base(led.number);
  led.braking = (now.translation() - before.translation()).norm() > 1e-6 ||
                angle_between(now.linear(), before.linear()) > 1e-6;
}

void Simulation::approach(const Command& command, int hand) {
  if (world_->hand_touches_anything(hand)) return;
  for (const Led& other : hands_)
    if (other.number != hand &&
        (world_->base(other.number).translation() - command.X_WB.translation()).norm() < apart / 2)
      return;
  const grasping::HandMotion before = world_->hand_motion(hand);
  world_->place_hand(command.X_WB, before.dof, hand);
  const double margin = 0.02;
  bool free = command.X_WB.translation().z() > 0;
  for (int i = 0; i < world_->body_count(); ++i)
    free = free && world_->distance_to_hand(i, margin, hand) >= margin;
  if (!free) world_->place_hand(before.X_WB, before.dof, hand);
}

Duration Simulation::follow(Time now, bool lockstep) {
  const Duration behind = now - time_;
  if (time_ == Time{}) {
    time_ = now;
  } else if (const Duration most = lockstep ? max_jump : options_.max_behind; behind > most) {
    // Live, the newest of what is behind is stepped; after a jump of the recording nothing is.
    time_ = lockstep ? now : now - most;
    goal_ = now;
    return lockstep ? behind : behind - most;
  }
  goal_ = now;
  return Duration::zero();
}

bool Simulation::step() {
  if (time_ + period_ > goal_) return false;
  time_ += period_;
  for (Led& led : hands_) {
    if (led.holding || time_ - led.accepted <= options_.stale) continue;
    world_->hold_still(led.number);
    if (arm_) arm_->brake();
    led.holding = true;
  }
  if (arm_) arm_->step(*world_);
  world_->step();
  const std::vector<grasping::Touch> touches = world_->touches();
  for (Led& led : hands_) {
    led.touch.update(touches, world_->base(led.number));
    if (led.braking) brake(led);
  }
  if (closures_ == 0 && time_ - looked_ >= look) put_back();
  for (Led& led : hands_) look_for_closure(led);
  return true;
}

void Simulation::look_for_closure(Led& led) {
  const auto body = led.detector.update(*world_);
  if (!body || !led.command) return;
  const grasping::HandMotion motion = world_->hand_motion(led.number);
  Closure closure;
  closure.number = closures_++;
  closure.time = time_;
  closure.hand = led.number;
  closure.command = *led.command;
  closure.body = *body;
  closure.object = world_->body(*body);
  closure.dof = motion.dof;
  closure.X_BO = motion.X_WB.inverse() * world_->body_motion(*body).X_WO;
  closure.contacts = world_->contacts(*body);
  closure.world = world_->clone();
  led.closure = std::move(closure);
}

std::optional<carrying::ArmMotion> Simulation::arm_motion() const {
  if (!arm_) return std::nullopt;
  return arm_->motion(*world_);
}

std::optional<Closure> Simulation::take_closure() {
  for (Led& led : hands_)
    if (led.closure) return std::exchange(led.closure, std::nullopt);
  return std::nullopt;
}

}  // namespace prehend::simulation
