#include "common/gate/limits.hpp"

#include <cmath>

#include "common/model/hand_effort.hpp"

namespace prehend::gate {
namespace {

constexpr double margin = 1.2;
/// Full speed is reached in this time, s, unless somebody says otherwise: a person starts and stops
/// from one frame of the glove to the next, and mapping does not smooth that.
constexpr double start_up = 0.004;

bool is_sound(const MotionLimit& limit) {
  return std::isfinite(limit.speed) && limit.speed > 0 && std::isfinite(limit.acceleration) &&
         limit.acceleration > 0;
}

}  // namespace

Limits limits_of(const model::HandModel& hand) {
  Limits limits;
  const model::HandGate& own = hand.gate();
  const auto count = static_cast<Eigen::Index>(hand.dofs().size());
  limits.lower.resize(count);
  limits.upper.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    limits.lower[i] = own.lower ? (*own.lower)[i] : dof.lower;
    limits.upper[i] = own.upper ? (*own.upper)[i] : dof.upper;
    const double speed = own.velocity ? (*own.velocity)[i] : margin * dof.max_velocity;
    limits.joint.push_back({speed, own.acceleration ? (*own.acceleration)[i] : speed / start_up});
  }
  limits.effort = own.effort ? *own.effort : model::max_effort(hand);
  return limits;
}

Expected<void> check(const Limits& limits) {
  for (const MotionLimit& joint : limits.joint)
    if (!is_sound(joint)) return fail("speed and acceleration must be positive", "gate");
  if (!limits.effort.allFinite() || !(limits.effort.array() > 0).all())
    return fail("effort must be positive", "gate.effort", "a share above 0 up to 1");
  if (!is_sound(limits.base) || !is_sound(limits.turn))
    return fail("speed and acceleration of the base must be positive", "gate");
  if (!(limits.box_lower.array() < limits.box_upper.array()).all())
    return fail("the box is empty", "gate.box", "lower x, y, z, then upper x, y, z, in m");
  return {};
}

}  // namespace prehend::gate
