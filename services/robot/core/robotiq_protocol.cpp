#include "services/robot/core/robotiq_protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/hand_effort.hpp"

namespace prehend::robot::robotiq {
namespace {

std::uint16_t pair(unsigned high, unsigned low) {
  return static_cast<std::uint16_t>(high << 8 | low);
}
std::uint8_t high(std::uint16_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}
std::uint8_t low(std::uint16_t value) {
  return static_cast<std::uint8_t>(value & 0xff);
}

/// A byte that goes over the range in even steps.
std::uint8_t byte_of(double value, double lower, double upper) {
  return static_cast<std::uint8_t>(
      std::lround(255 * std::clamp((value - lower) / (upper - lower), 0.0, 1.0)));
}
double value_of(std::uint8_t byte, double lower, double upper) {
  return lower + (upper - lower) * byte / 255;
}

}  // namespace

modbus::Registers encode(const Action& action) {
  return {pair(action.bits, 0), pair(0, action.position), pair(action.speed, action.force)};
}

Action action_of(const modbus::Registers& registers) {
  return {high(registers[0]), low(registers[1]), high(registers[2]), low(registers[2])};
}

modbus::Registers encode(const Status& status) {
  const unsigned bits = status.bits | static_cast<unsigned>(status.activation) << 4 |
                        static_cast<unsigned>(status.object) << 6;
  return {pair(bits, 0), pair(status.fault, status.goal), pair(status.position, status.current)};
}

Status status_of(const modbus::Registers& registers) {
  const std::uint8_t bits = high(registers[0]);
  return {static_cast<std::uint8_t>(bits & (active | goes)),
          static_cast<Activation>(bits >> 4 & 3),
          static_cast<Object>(bits >> 6),
          static_cast<std::uint8_t>(high(registers[1]) & 0x0f),
          low(registers[1]),
          high(registers[2]),
          low(registers[2])};
}

std::string explain_fault(std::uint8_t fault) {
  static constexpr std::array texts{"no fault",
                                    "fault 1",
                                    "fault 2",
                                    "fault 3",
                                    "fault 4",
                                    "it must be activated first",
                                    "fault 6",
                                    "it is not activated",
                                    "it is too hot",
                                    "nobody spoke to it",
                                    "its voltage is too low",
                                    "it releases by itself",
                                    "an internal fault",
                                    "its activation failed",
                                    "overcurrent",
                                    "it has released by itself"};
  return fault < texts.size() ? texts[fault] : "fault " + std::to_string(fault);
}

bool ends_activation(std::uint8_t fault) {
  return fault == needs_activation || fault == no_activation || fault == 10 || fault > releasing;
}

Scale::Scale(const model::HandModel& hand, const Kind& kind)
    : kind_(kind),
      lower_(hand.dofs()[0].lower),
      range_(hand.dofs()[0].upper - hand.dofs()[0].lower),
      max_effort_(model::max_effort(hand)[0]),
      meters_(kind.opening / range_) {}

double Scale::dof_of(double count) const {
  return lower_ + range_ * (count - open_count) / (closed_count - open_count);
}

double Scale::count_of(double dof) const {
  return std::clamp(open_count + counts(dof - lower_), 0.0, 255.0);
}

double Scale::counts(double way) const {
  return (closed_count - open_count) * way / range_;
}

/// What the motor does along the DoF, both pads do along the opening.
std::uint8_t Scale::force_count(double effort) const {
  return byte_of(effort / meters_, kind_.min_force, kind_.max_force);
}

double Scale::effort_of(std::uint8_t force) const {
  return value_of(force, kind_.min_force, kind_.max_force) * meters_;
}

std::uint8_t Scale::speed_count(double velocity) const {
  return byte_of(velocity * meters_, kind_.min_speed, kind_.max_speed);
}

double Scale::velocity_of(std::uint8_t speed) const {
  return value_of(speed, kind_.min_speed, kind_.max_speed) / meters_;
}

Expected<void> check_hand(const model::HandModel& hand, const Kind& kind) {
  if (hand.dofs().size() == 1 && hand.dofs()[0].closing == 1) return {};
  return wrong_use("a " + std::string(kind.title) + " has one motor, which closes it", hand.name(),
                   "give " + std::string(kind.name));
}

}  // namespace prehend::robot::robotiq
