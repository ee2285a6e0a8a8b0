#include "services/robot/core/robotiq_gripper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/model/hand_effort.hpp"

namespace prehend::robot::robotiq {
namespace {

constexpr double max_count = 232;         // where its stop is
constexpr double activation_speed = 0.6;  // of the fastest
constexpr Duration stalls_after = std::chrono::milliseconds(120);
constexpr Duration watches = std::chrono::seconds(1);
constexpr double there = 1.5;  // counts

}  // namespace

Gripper::Gripper(const model::HandModel& hand, const Kind& kind, bool activated,
                 double velocity_scale)
    : map{action_at, status_at, modbus::Registers(register_count), {}},
      scale_(hand, kind),
      squeeze_(scale_.counts(hand.dofs()[0].squeeze)),
      full_(model::max_effort(hand)[0]),
      velocity_scale_(velocity_scale) {
  if (activated) {
    action_.bits = active;
    map.written = encode(action_);
    status_.bits = active;
    status_.activation = Activation::done;
  }
  tell();
}

void Gripper::hear(Duration now) {
  heard_ = now;
}

void Gripper::restart() {
  action_ = {};
  status_ = {};
  map.written = encode(action_);
  leg_ = 0;
  driven_ = position_;
  tell();
}

void Gripper::measure(double dof) {
  twin_ = true;
  if (!blocked_) position_ = scale_.count_of(dof);
}

void Gripper::pass(Duration now) {
  const double dt = to_seconds(now - now_);
  now_ = now;
  obey(action_of(map.written));
  if (status_.activation == Activation::busy)
    activate(dt);
  else if (status_.activation == Activation::done && (action_.bits & goes) != 0 && !hot_)
    move(dt, std::min<double>(action_.position, max_count), scale_.velocity_of(action_.speed),
         std::clamp(scale_.effort_of(action_.force) / full_, 0.0, 1.0));
  else
    driven_ = position_;
  watch_object(now);
  unheard_ = now - heard_ > watches;
  tell();
}

void Gripper::obey(const Action& action) {
  const Action last = std::exchange(action_, action);
  const bool was = (last.bits & active) != 0, is = (action.bits & active) != 0;
  if (!is) {
    const std::uint8_t fault = (action.bits & goes) != 0 ? no_activation : 0;
    status_ = {.fault = fault};
    return;
  }
  if (!was) {
    status_.activation = Activation::busy;
    leg_ = 0;
    still_since_ = now_;
  }
  status_.bits = static_cast<std::uint8_t>(action.bits & (active | goes));
  status_.goal = action.position;
  // What it presses against stays in its way while it shall go the same way.
  const bool on = (status_.object == Object::while_closing && action.position > position_) ||
                  (status_.object == Object::while_opening && action.position < position_);
  if (action.bits == last.bits && (action.position == last.position || on)) return;
  if (status_.object != Object::moving || action.bits != last.bits) still_since_ = now_;
  status_.object = Object::moving;
}

/// One that is kept from moving presses: with its whole way while it goes, with its force when it
/// does not.
void Gripper::move(double dt, double goal, double speed, double share) {
  const double step = scale_.counts(speed) * dt * velocity_scale_;
  driven_ += std::clamp(goal - driven_, -step, step);
  const bool stands = now_ - still_since_ > stalls_after / 2;
  const double most = squeeze_ * (stands ? share : 1);
  if (blocked_)
    driven_ = position_;
  else if (twin_)
    driven_ = position_ + std::clamp(driven_ - position_, -most, most);
  else
    position_ = driven_;
}

void Gripper::activate(double dt) {
  const double goals[] = {0.0 + open_count, 0.0 + closed_count, 0.0 + open_count};
  const double fastest = activation_speed * scale_.velocity_of(255);
  move(dt, goals[leg_], fastest, 1);
  const bool stalls = now_ - still_since_ > 2 * stalls_after;
  if (std::abs(goals[leg_] - position_) > there && (!stalls || blocked_)) return;
  still_since_ = now_;
  if (++leg_ == 3) status_.activation = Activation::done;
}

void Gripper::watch_object(Duration now) {
  if (std::abs(position_ - seen_) > 1) {
    seen_ = position_;
    still_since_ = now;
  }
  if (status_.activation != Activation::done || (action_.bits & goes) == 0) {
    status_.object = Object::moving;
    return;
  }
  const double goal = std::clamp<double>(action_.position, open_count, closed_count);
  if (std::abs(goal - position_) <= there)
    status_.object = Object::none;
  else if (now - still_since_ > stalls_after && !blocked_ && !hot_)
    status_.object = goal > position_ ? Object::while_closing : Object::while_opening;
  else if (status_.object == Object::none || now == still_since_)
    status_.object = Object::moving;
}

void Gripper::tell() {
  Status told = status_;
  if (hot_) told.fault = hot;
  if (unheard_ && told.fault == 0) told.fault = unheard;
  told.position = static_cast<std::uint8_t>(std::lround(std::clamp(position_, 0.0, 255.0)));
  const bool presses = told.object == Object::while_closing || told.object == Object::while_opening;
  told.current = presses ? 30 : told.object == Object::moving && (told.bits & goes) != 0 ? 10 : 0;
  map.status = encode(told);
}

}  // namespace prehend::robot::robotiq
