#include "common/grasping/placed_hand.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double beyond = 0.01;  // share of a DoF's range that rounding may leave its limits
// What a pushed base presses on is so near, and it moves slower than this, m/s and rad/s.
constexpr double pressed_m = 0.02, pressed_rad = 0.1, pressing_speed = 0.05;

Expected<void> check(const model::HandModel& hand, const Pose& X_WB, const VectorXd& dof) {
  if (!is_finite(X_WB)) return fail("the hand's pose must be finite", "world");
  if (dof.size() != static_cast<Eigen::Index>(hand.dofs().size()) || !dof.allFinite())
    return fail("the hand needs " + std::to_string(hand.dofs().size()) + " finite DoF values",
                "world");
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    const double slack = beyond * (limits.upper - limits.lower);
    if (dof[i] < limits.lower - slack || dof[i] > limits.upper + slack)
      return fail("is outside its limits", limits.name,
                  std::to_string(limits.lower) + " to " + std::to_string(limits.upper));
  }
  return {};
}

Expected<std::vector<analysis::Material>> materials_of(const model::HandModel& hand) {
  std::vector<analysis::Material> materials;
  for (const model::HandLink& link : hand.links()) {
    const auto material = analysis::material_from_string(link.material);
    if (!material)
      return fail("unknown material " + link.material, link.name,
                  "glass, metal, plastic, wood, rubber or stone");
    materials.push_back(*material);
  }
  return materials;
}

}  // namespace

Expected<std::unique_ptr<PlacedHand>> PlacedHand::create(const model::HandModel& hand, int number,
                                                         const Pose& X_WB, const VectorXd& dof,
                                                         const WorldOptions& options,
                                                         btMultiBodyDynamicsWorld& bullet,
                                                         LinkPairFilter& filter) {
  if (auto valid = check(hand, X_WB, dof); !valid) return tl::unexpected(valid.error());
  const auto materials = materials_of(hand);
  if (!materials) return tl::unexpected(materials.error());
  std::unique_ptr<PlacedHand> made(
      new PlacedHand(hand, *materials, options, bullet, filter, number));
  static_cast<void>(made->place(X_WB, dof));
  return made;
}

PlacedHand::PlacedHand(const model::HandModel& hand,
                       const std::vector<analysis::Material>& materials,
                       const WorldOptions& options, btMultiBodyDynamicsWorld& bullet,
                       LinkPairFilter& filter, int number)
    : hand_(hand),
      options_(options),
      dt_(1.0 / options.rate),
      body_(hand, materials, bullet, filter, dt_, options.base, number) {}

Expected<void> PlacedHand::place(const Pose& X_WB, const VectorXd& dof) {
  if (auto valid = check(hand_, X_WB, dof); !valid) return valid;
  body_.place(X_WB, hand_.joint_angles(hand_.clamp(dof)),
              VectorXd::Zero(static_cast<Eigen::Index>(hand_.joints().size())));
  arm_.stop();
  carrier_.reset();
  braking_ = false;
  X_WB_command_ = X_WB;
  velocity_command_.setZero();
  dof_command_ = hand_.clamp(dof);
  return {};
}

Expected<void> PlacedHand::command(const Pose& X_WB, const VectorXd& dof,
                                   const Vector3d& velocity) {
  if (auto valid = check(hand_, X_WB, dof); !valid) return valid;
  if (!velocity.allFinite()) return fail("the hand's velocity must be finite", "world");
  X_WB_command_ = X_WB;
  velocity_command_ = velocity;
  dof_command_ = hand_.clamp(dof);
  braking_ = false;
  return {};
}

Expected<void> PlacedHand::limit_effort(const VectorXd& effort) {
  if (effort.size() != 0 && effort.size() != dof_command_.size())
    return fail("efforts of another hand", "world");
  if (!effort.allFinite() || (effort.array() < 0).any())
    return fail("efforts must be 0 or more", "world");
  effort_ = effort;
  return {};
}

void PlacedHand::brake() {
  hold_still();
  braking_ = true;
}

void PlacedHand::hold_still() {
  const bool presses = options_.push && body_.base_velocity().norm() < pressing_speed &&
                       body_.base_turning().norm() < pressing_speed;
  X_WB_command_ =
      presses ? limit_step(body_.X_WB(), X_WB_command_, pressed_m, pressed_rad) : body_.X_WB();
  velocity_command_.setZero();
  for (Eigen::Index i = 0; i < dof_command_.size(); ++i) {
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(i)];
    const double motor = body_.motor(static_cast<int>(i));
    const double speed = std::abs(body_.motor_velocity(static_cast<int>(i)));
    const double keep = speed > 0.05 * radian_of(dof) ? 0 : dof.squeeze;
    double& commanded = dof_command_[i];
    commanded = std::clamp(commanded, motor - keep, motor + keep);
  }
  dof_command_ = hand_.clamp(dof_command_);
}

void PlacedHand::carry(const Pose& X_WB, const Push& most) {
  if (!carrier_) carrier_.emplace();
  carrier_->aim(body_.X_WC_of(X_WB), most);
  X_WB_command_ = X_WB;
}

BaseLoad PlacedHand::base_load() const {
  if (!carrier_) return {};
  return carrier_->load(body_.base_velocity(), body_.base_turning(), options_.base, dt_);
}

void PlacedHand::drive() {
  if (carrier_) {
    carrier_->step(body_.X_WC(), body_.base_velocity(), body_.base_turning(), options_.base, dt_);
    body_.move_base(carrier_->velocity(), carrier_->turning());
  } else {
    if (options_.push) arm_.feel(body_.base_velocity(), body_.base_turning());
    arm_.step(body_.X_WC(), body_.X_WC_of(X_WB_command_), velocity_command_, arm_limits(), dt_);
    body_.move_base(arm_.velocity(), arm_.turning());
  }
  body_.drive(dof_command_, effort_);
}

ArmLimits PlacedHand::arm_limits() const {
  ArmLimits limits = options_.arm;
  if (braking_) {
    limits.acceleration = options_.brake.acceleration;
    limits.turn_acceleration = options_.brake.turn_acceleration;
  }
  if (!options_.push) return limits;
  const auto& [force, torque] = *options_.push;
  limits.acceleration = std::min(limits.acceleration, force / options_.base.mass);
  limits.turn_acceleration = std::min(limits.turn_acceleration, torque / options_.base.inertia);
  return limits;
}

void PlacedHand::copy_state(const PlacedHand& other) {
  body_.copy_state(other.body_);
  arm_ = other.arm_;
  X_WB_command_ = other.X_WB_command_;
  velocity_command_ = other.velocity_command_;
  effort_ = other.effort_;
  braking_ = other.braking_;
}

HandMotion PlacedHand::motion() const {
  const auto count = static_cast<Eigen::Index>(hand_.joints().size());
  const Eigen::Index dofs = dof_command_.size();
  HandMotion motion{body_.X_WB(),    VectorXd(dofs),  VectorXd(dofs),
                    VectorXd(count), VectorXd(count), VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    motion.joint[i] = body_.joint(i);
    motion.velocity[i] = body_.velocity(i);
    motion.torque[i] = body_.torque(i);
  }
  for (Eigen::Index i = 0; i < dofs; ++i) {
    motion.dof[i] = motion.joint[hand_.dofs()[static_cast<std::size_t>(i)].joint];
    motion.motor[i] = body_.motor(static_cast<int>(i));
  }
  return motion;
}

}  // namespace prehend::grasping
