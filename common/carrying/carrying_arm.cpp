#include "common/carrying/carrying_arm.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/arm/inverse.hpp"
#include "common/arm/mounting.hpp"

namespace prehend::carrying {
namespace {

using Eigen::Vector3d;

const Vector3d gravity_W(0, 0, -9.81);
constexpr double smoothed = 0.1;         // s, of what is lifted
constexpr double much_too_heavy = 1.25;  // times the payload: such a thing is not lifted
constexpr double behind_m = 0.02, behind_rad = 0.1;  // so far a blocked hand may be behind
constexpr double same_m = 1e-5, same_rad = 1e-4;     // as told, or beside it
constexpr double near_rad = 0.3;  // by which joints may differ from what they are told

}  // namespace

Expected<std::unique_ptr<CarryingArm>> CarryingArm::create(model::ArmModel arm,
                                                           const model::HandModel& hand,
                                                           const Pose& X_WA, const Pose& X_EB) {
  if (const auto fits = arm::check_fit(arm, hand); !fits) return tl::unexpected(fits.error());
  // The table is level in W; of an arm that stands aslant the controller knows no table.
  arm::ControllerOptions options;
  options.X_WA = X_WA;
  options.X_EB = X_EB;
  if (X_WA.linear().col(2).z() > 0.9999) options.surroundings.table = -X_WA.translation().z();
  for (const model::CollisionShape& shape : hand.links().front().collision) {
    const model::Capsule part = model::capsule_around(shape);
    const Pose X_LB = arm.X_LE * X_EB;
    options.surroundings.carried.push_back({X_LB * part.a, X_LB * part.b, part.radius});
  }
  options.surroundings.may_touch = true;
  return std::unique_ptr<CarryingArm>(new CarryingArm(std::move(arm), hand, std::move(options)));
}

CarryingArm::CarryingArm(model::ArmModel arm, const model::HandModel& hand,
                         arm::ControllerOptions options)
    : arm_(std::move(arm)), options_(std::move(options)), controller_(arm_, options_) {
  const Pose X_LB = arm_.X_LE * options_.X_EB;
  burden_.mass = arm::weight_of(hand);
  const auto X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < X_BL.size(); ++i)
    moment += hand.links()[i].mass * (X_BL[i] * hand.links()[i].com_L);
  burden_.com_L = X_LB * Vector3d(moment / std::max(burden_.mass, 1e-6));
  burden_.p_L = X_LB * hand.links().front().com_L;
  start(arm_.home);
}

void CarryingArm::start(const arm::Joints& q) {
  controller_.start(q);
  acceleration_.setZero(q.size());
  load_ = {};
  lifted_ = 0;
  too_heavy_ = pushed_ = false;
  wish_.reset();
  guidance_ = controller_.brake(0);
  guidance_.hindrance = arm::Hindrance::none;
  X_WB_ = guidance_.X_WB;
}

/// About what the Puma weighs at its end, by the inertias of its links.
grasping::BaseBody CarryingArm::base() {
  return {.mass = 10, .inertia = 0.2};
}

Pose CarryingArm::home() const {
  return options_.X_WA * arm::end_pose(arm_, arm_.home) * options_.X_EB;
}

void CarryingArm::follow(const Pose& X_WB) {
  wish_ = X_WB;
}

void CarryingArm::brake() {
  wish_.reset();
}

bool CarryingArm::rests() const {
  return controller_.velocity().cwiseAbs().maxCoeff() < 1e-6;
}

arm::Joints CarryingArm::torques(const arm::Joints& q, const arm::Burden& burden) const {
  const arm::Joints zero = arm::Joints::Zero(q.size());
  return arm::drive_torques(arm_, q, zero, zero, burden,
                            options_.X_WA.linear().transpose() * gravity_W);
}

/// What the hand touches and carries.
void CarryingArm::feel(const grasping::World& world) {
  load_ = world.base_load();
  X_WB_ = world.base();
  lifted_ += std::min(1.0, world.time_step() / smoothed) * (-load_.force.z() - lifted_);
  const double mass = burden_.mass + std::max(0.0, lifted_) / -gravity_W.z();
  too_heavy_ = arm_.payload > 0 && mass > much_too_heavy * arm_.payload;
  const arm::Vector6 behind = arm::way_between(X_WB_, guidance_.X_WB);
  pushed_ = behind.head<3>().norm() > behind_m || behind.tail<3>().norm() > behind_rad;
}

/// A hand that something keeps behind its arm is not led farther away, and what is too heavy not
/// higher up.
Pose CarryingArm::bounded(const Pose& X_WB) const {
  Pose X = pushed_ ? limit_step(X_WB_, X_WB, behind_m, behind_rad) : X_WB;
  if (too_heavy_) X.translation().z() = std::min(X.translation().z(), X_WB_.translation().z());
  return X;
}

void CarryingArm::step(grasping::World& world) {
  feel(world);
  const double dt = world.time_step();
  const arm::Joints before = controller_.velocity();
  if (wish_)
    guidance_ = controller_.step({bounded(*wish_), arm::Vector6::Zero()}, dt);
  else
    guidance_ = controller_.brake(dt);
  acceleration_ = (guidance_.velocity - before) / dt;
  const arm::Strength left =
      arm::strength_left(arm_, guidance_.q, torques(guidance_.q, burden_), burden_.p_L);
  world.carry(guidance_.X_WB, {left.force, left.torque});
}

ArmMotion CarryingArm::motion(const grasping::World& world) const {
  ArmMotion motion;
  motion.told = guidance_.q;
  motion.told_velocity = guidance_.velocity;
  motion.joint = guidance_.q;
  // A hand that is pushed away takes the joints along.
  const arm::Vector6 beside = arm::way_between(guidance_.X_WB, world.base());
  if (beside.head<3>().norm() > same_m || beside.tail<3>().norm() > same_rad) {
    const Pose X_AE = options_.X_WA.inverse() * world.base() * options_.X_EB.inverse();
    const auto pushed = arm::refine(arm_, X_AE, guidance_.q);
    if (pushed && arm::is_within_limits(arm_, *pushed) &&
        (*pushed - guidance_.q).cwiseAbs().maxCoeff() < near_rad)
      motion.joint = *pushed;
  }
  motion.X_WB = options_.X_WA * arm::end_pose(arm_, motion.joint) * options_.X_EB;

  arm::Burden burden = burden_;
  const Eigen::Matrix3d R_AW = options_.X_WA.linear().transpose();
  burden.force_A = R_AW * load_.force;
  burden.torque_A = R_AW * load_.torque;
  motion.torque = arm::drive_torques(arm_, motion.joint, guidance_.velocity, acceleration_, burden,
                                     R_AW * gravity_W);
  for (Eigen::Index i = 0; i < motion.torque.size(); ++i) {
    const double most = arm_.joints[static_cast<std::size_t>(i)].max_torque;
    if (most > 0) motion.torque[i] = std::clamp(motion.torque[i], -most, most);
  }
  if (wish_) {
    const arm::Vector6 off = arm::way_between(motion.X_WB, *wish_);
    motion.off_m = off.head<3>().norm();
    motion.off_rad = off.tail<3>().norm();
  }
  motion.hindrance = pushed_ ? arm::Hindrance::collision : guidance_.hindrance;
  motion.carried = burden_.mass + std::max(0.0, lifted_) / -gravity_W.z();
  motion.too_heavy = too_heavy_;
  return motion;
}

}  // namespace prehend::carrying
