#include "services/robot/core/robotiq_driver.hpp"

#include <fmt/format.h>

#include <cmath>

namespace prehend::robot::robotiq {
namespace {

using std::chrono::milliseconds;

constexpr Duration pause = milliseconds(5);
constexpr Duration homes_for = std::chrono::seconds(20);
constexpr double smoothing = 0.05;       // s, of its velocity
constexpr int near = 4;                  // counts: there
constexpr std::size_t frame_bytes = 26;  // there and back

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options, const Kind& kind) {
  if (auto fits = check_hand(hand, kind); !fits) return tl::unexpected(fits.error());
  if (options.id < 0 || options.id > 247) return wrong_use("must be 1 to 247", "robot.id");
  return std::make_unique<Driver>(hand, options, kind);
}

}  // namespace

Expected<std::unique_ptr<robot::Driver>> create_2f85(const model::HandModel& hand,
                                                     const DriverOptions& options) {
  return create(hand, options, kind_2f85);
}

Expected<std::unique_ptr<robot::Driver>> create_2f140(const model::HandModel& hand,
                                                      const DriverOptions& options) {
  return create(hand, options, kind_2f140);
}

Driver::Driver(const model::HandModel& hand, const DriverOptions& options, const Kind& kind)
    : PolledDriver(hand, options, {pause, patience_for(frame_bytes, options.baud)}),
      kind_(kind),
      scale_(hand, kind),
      id_(options.id == 0 ? usual_id : static_cast<std::uint8_t>(options.id)),
      speed_(scale_.speed_count(hand.dofs()[0].max_velocity)) {}

void Driver::begin(Time now) {
  status_.reset();
  wanted_.reset();
  told_.reset();
  homing_ = Homing::none;
  read_ = now - seconds(1 / options_.rate);
}

// --- what it shall do

void Driver::home() {
  if ((phase_ != Phase::configured && phase_ != Phase::ready) || !status_) return;
  homing_ = Homing::resets;
  wanted_ = Action{};  // an edge of rACT: faults end only by that
  be(Phase::homing);
}

void Driver::follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time) {
  if (phase_ != Phase::ready) return;
  const double force = effort.size() > 0 ? effort[0] : scale_.max_effort();
  wanted_ = Action{active | goes, static_cast<std::uint8_t>(std::lround(scale_.count_of(dof[0]))),
                   speed_, scale_.force_count(force)};
}

void Driver::hold() {
  if (phase_ == Phase::homing) {
    need_activation("its activation was broken off");
  } else if (phase_ == Phase::ready && !presses()) {
    wanted_ = halt();
  }
}

std::string Driver::stay() {
  const bool moves = status_ && (phase_ == Phase::ready || phase_ == Phase::homing);
  if (!moves || presses()) return {};
  return tell(phase_ == Phase::homing ? Action{} : halt());
}

/// Something is between the fingers, and they close on it, or open against it.
bool Driver::presses() const {
  return status_ && (status_->bits & goes) != 0 &&
         (status_->object == Object::while_closing || status_->object == Object::while_opening);
}

Action Driver::halt() const {
  return {active, status_->position, speed_, 0};
}

// --- the conversation

std::string Driver::question(Time now) {
  if (status_ && wanted_ && must_tell() && asked_ != modbus::Function::write) {
    asked_ = modbus::Function::write;
    return tell(*wanted_);
  }
  // What was told shows in the next status, so that comes at once.
  if (asked_ != modbus::Function::write && now - read_ < seconds(1 / options_.rate)) return {};
  asked_ = modbus::Function::read_input;
  read_ = now;
  return encode(modbus::read(id_, asked_, status_at, register_count));
}

std::string Driver::tell(const Action& action) {
  said_ = action;
  return encode(modbus::write(id_, action_at, encode(action)));
}

/// An answer may be a late one, to what was told before: its echo counts as well.
bool Driver::must_tell() const {
  return told_ != wanted_ || status_->goal != wanted_->position ||
         status_->bits != (wanted_->bits & (active | goes));
}

PolledDriver::Heard Driver::hear(Time now) {
  const auto frame = parser_.next();
  for (int n = parser_.take_broken(); n > 0; --n) count_reject("garbled answer");
  if (!frame) return Heard::nothing;
  if (is_of_another(id_, frame->id)) return Heard::foreign;
  if (frame->function == (static_cast<unsigned>(asked_) | modbus::refused)) {
    const auto code = static_cast<std::uint8_t>(frame->data[0]);
    suspect("it refuses: " + modbus::explain_refusal(code));
    count_reject("it refuses: " + modbus::explain_refusal(code));
    return Heard::refusal;
  }
  return take(*frame, now) ? Heard::answer : Heard::foreign;
}

bool Driver::take(const modbus::Frame& answer, Time now) {
  const bool fits = answer.function == static_cast<std::uint8_t>(asked_);
  if (fits && asked_ == modbus::Function::write) {
    told_ = said_;
    return true;
  }
  const auto registers = modbus::registers_of(answer, register_count);
  if (!fits || !registers) {
    count_reject("answer to another question");
    return false;
  }
  take(status_of(*registers), now);
  return true;
}

void Driver::take(const Status& status, Time now) {
  const bool first = !status_;
  const Status last = status_.value_or(status);
  status_ = status;
  identity_ = fmt::format("{}, id {}", kind_.title, id_);
  if (first) kept_.forget();
  if (first || homing_ == Homing::none) homes_since_ = now;
  observe(last, now);
  if (homing_ != Homing::none)
    judge_homing();
  else
    judge();
  if (homing_ != Homing::none && now - homes_since_ > homes_for)
    need_activation("its activation does not end");
}

// --- what it says

void Driver::judge() {
  if (ends_activation(status_->fault)) return need_activation(explain_fault(status_->fault));
  if (status_->fault == hot || status_->fault == releasing) {
    if (phase_ == Phase::ready && !presses()) wanted_ = halt();
    return be(Phase::faulted, explain_fault(status_->fault));
  }
  if (status_->activation == Activation::done && (status_->bits & active) != 0)
    return phase_ == Phase::ready ? void() : become_ready();
  if (phase_ != Phase::configured)
    need_activation(phase_ == Phase::ready ? "it has lost its activation" : "it is not activated");
}

void Driver::judge_homing() {
  const bool is_active = (status_->bits & active) != 0;
  if (homing_ == Homing::resets) {
    if (is_active || status_->activation != Activation::reset) return;
    homing_ = Homing::activates;
    wanted_ = Action{active, 0, 0, 0};
    return;
  }
  if (is_active && status_->activation == Activation::done) {
    homing_ = Homing::none;
    become_ready();
  } else if (is_active && ends_activation(status_->fault)) {
    need_activation(explain_fault(status_->fault));
  }
}

/// It stays where it is, and keeps what it holds, until it is told where to go.
void Driver::become_ready() {
  be(Phase::ready);
  wanted_.reset();
  if (!presses()) wanted_ = halt();
}

/// One whose activation was broken off is reset, so that it stands still.
void Driver::need_activation(const std::string& why) {
  if (phase_ == Phase::homing)
    wanted_ = Action{};
  else if (phase_ == Phase::ready)
    wanted_.reset();
  homing_ = Homing::none;
  be(Phase::configured, why + " (activating it opens and closes its fingers fully)");
}

void Driver::observe(const Status& last, Time now) {
  if (status_->activation != Activation::done) return;
  const double moved = scale_.dof_of(status_->position) - scale_.dof_of(last.position);
  const double dt = reading_ ? to_seconds(now - reading_->stamp) : 0;
  if (dt > 0) velocity_ += (moved - velocity_ * dt) / (dt + smoothing);
  kept_.observe(status_->position != last.position || status_->object != Object::moving ||
                    (status_->bits & goes) == 0 ||
                    std::abs(status_->goal - status_->position) <= near,
                now);
  const double effort = !presses() ? 0.0
                                   : (status_->object == Object::while_closing ? 1 : -1) *
                                         scale_.effort_of(said_.force);
  reading_ = Reading{now,
                     Eigen::VectorXd::Constant(1, scale_.dof_of(status_->position)),
                     Eigen::VectorXd::Constant(1, velocity_),
                     Eigen::VectorXd::Constant(1, effort),
                     {}};
}

std::optional<std::string> Driver::what_is_wrong() const {
  if (phase_ == Phase::ready && kept_.stuck()) return hand_.dofs()[0].name + " is stuck";
  return std::nullopt;
}

}  // namespace prehend::robot::robotiq
