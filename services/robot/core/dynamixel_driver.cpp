#include "services/robot/core/dynamixel_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace prehend::robot::dynamixel {
namespace {

using std::chrono::milliseconds;

constexpr int max_tries = 3;
constexpr Duration rest = milliseconds(500);
constexpr Duration check_period = milliseconds(500);  // of heat and torque in turn
constexpr double cool = 3;                            // °C below the limit, after it was passed
constexpr double margin = 0.1;    // rad, that a joint may be past its range when it is found
constexpr double near = 0.02;     // rad: there
constexpr double still = 0.03;    // rad/s
constexpr double far = 0.5;       // rad, but at most a third of the range
constexpr double speed_up = 1.2;  // how much faster than the hand may be a servo goes to its goal

}  // namespace

Expected<std::unique_ptr<robot::Driver>> create(const model::HandModel& hand,
                                                const DriverOptions& options) {
  constexpr std::array bauds{9600, 57600, 115200, 1000000, 2000000, 3000000, 4000000};
  if (std::find(bauds.begin(), bauds.end(), options.baud) == bauds.end())
    return wrong_use("servos know 9600, 57600, 115200 bits per second and 1 to 4 million",
                     "robot.baud");
  auto servos = parse_wiring(options.wiring, hand, options.wiring_file);
  if (!servos) return tl::unexpected(servos.error());
  return std::make_unique<Driver>(hand, options, std::move(*servos));
}

Driver::Driver(const model::HandModel& hand, const DriverOptions& options,
               std::vector<Servo> servos)
    : hand_(hand), options_(options), answers_(servos.size()) {
  for (const Servo& servo : servos)
    motions_.push_back({.servo = servo, .limit = servo.max_current, .allowed = servo.max_current});
}

void Driver::connected(Time now) {
  talk_ = Talk::resting;
  parser_.clear();
  asked_ = now - rest;
  if (phase_ == Phase::offline) trouble_ = "does not answer";
}

void Driver::disconnected(const std::string& why) {
  talk_ = Talk::silent;
  be(Phase::offline, why);
  armed_ = false;
}

std::string Driver::step(std::string_view heard, Time now) {
  if (talk_ == Talk::silent) return {};
  parser_.feed(heard);
  for (int n = parser_.take_broken(); n > 0; --n) count_reject("garbled answer");
  switch (talk_) {
    case Talk::resting:
      parser_.clear();
      return now - asked_ < rest ? std::string() : begin(now);
    case Talk::setting_up:
      return set_up(now);
    case Talk::explaining:
      return explain(now);
    default:
      return loop(now);
  }
}

void Driver::home() {
  if (phase_ == Phase::ready) wants_home_ = true;
}

void Driver::follow(const Eigen::VectorXd& dof, const Eigen::VectorXd& effort, Time) {
  for (Motion& motion : motions_) {
    const auto d = static_cast<Eigen::Index>(motion.servo.dof);
    motion.goal = static_cast<int>(std::lround(motion.servo.position_of(dof[d])));
    const double wanted = effort.size() > d ? std::abs(effort[d]) * motion.servo.current : 32767;
    const int allowed = static_cast<int>(std::min<double>(wanted, motion.limit));
    tells_current_ |= allowed != motion.allowed;
    motion.allowed = allowed;
  }
}

void Driver::hold() {
  wants_home_ = false;
  for (Motion& motion : motions_) {
    const model::HandDof& dof = hand_.dofs()[motion.servo.dof];
    const double squeeze = motion.kept.stalled() ? std::abs(dof.squeeze * motion.servo.pulses) : 0;
    motion.goal = static_cast<int>(std::lround(
        std::clamp<double>(motion.goal, motion.position - squeeze, motion.position + squeeze)));
  }
}

// --- set-up

std::string Driver::begin(Time now) {
  talk_ = Talk::setting_up;
  step_ = Step::ping;
  at_ = 0;
  tries_ = 0;
  temperature_.reset();
  // Those that were told to answer nothing but reads would seem to be lost.
  return encode({broadcast, Instruction::write, write_of(table::status_return, 2)}) + ask(now);
}

std::string Driver::ask(Time now) {
  parser_.clear();
  asked_ = now;
  return encode(question());
}

Packet Driver::question() const {
  const Motion& motion = motions_[at_];
  const auto reads = [&](const Item& item) {
    return Packet{motion.servo.id, Instruction::read, read_of(item)};
  };
  const auto writes = [&](const Item& item, std::int64_t value) {
    return Packet{motion.servo.id, Instruction::write, write_of(item, value)};
  };
  switch (step_) {
    case Step::ping:
      return {motion.servo.id, Instruction::ping, {}};
    case Step::hardware:
      return reads(table::hardware_error);
    case Step::heat:
      return reads(table::temperature);
    case Step::limit:
      return reads(table::current_limit);
    case Step::mode:
      return reads(table::operating_mode);
    case Step::let_go:
      return writes(table::torque_enable, 0);
    case Step::set_mode:
      return writes(table::operating_mode, current_based_position);
    case Step::unwatch:
      return writes(table::watchdog, 0);
    case Step::place:
      return reads(table::present_position);
    case Step::speed: {
      const double speed = speed_up * hand_.dofs()[motion.servo.dof].max_velocity;
      const double units = std::abs(motion.servo.pulses) * speed / pulses_per_second(1);
      return writes(table::profile_velocity, std::clamp(std::lround(units), 1L, 32767L));
    }
    case Step::current:
      return writes(table::goal_current, motion.allowed);
    case Step::goal:
      return writes(table::goal_position, motion.goal);
    case Step::torque:
      return writes(table::torque_enable, 1);
    case Step::watch:
      break;
  }
  const auto ms = std::chrono::ceil<milliseconds>(options_.lost_after).count();
  return writes(table::watchdog, std::clamp<long>(ms / watchdog_unit_ms + 2, 1, 127));
}

std::string Driver::set_up(Time now) {
  while (const auto packet = parser_.next())
    if (packet->id == motions_[at_].servo.id && packet->instruction == Instruction::status &&
        !packet->parameters.empty())
      return judge(*packet, now);
  if (now - asked_ < due(status_bytes + 4)) return {};
  if (++tries_ < max_tries) return ask(now);
  return lose(named(motions_[at_]) + " does not answer", now);
}

/// The answer to the last question.
std::string Driver::judge(const Packet& answer, Time now) {
  Motion& motion = motions_[at_];
  const auto error = static_cast<std::uint8_t>(answer.parameters[0]);
  const std::string_view value = std::string_view(answer.parameters).substr(1);
  if ((error & ~alert) != 0)
    return lose(named(motion) + " refuses: " + explain_refusal(error), now);
  const std::string expected = question().parameters;
  const bool reads = question().instruction == Instruction::read;
  if (reads && static_cast<int>(value.size()) != number(expected.substr(2, 2)))
    return lose(named(motion) + " answers nonsense", now);
  switch (step_) {
    case Step::ping:
      if (value.size() == 3 && at_ == 0)
        identity_ =
            fmt::format("{} DYNAMIXEL servos, the first of model {}, firmware {}", motions_.size(),
                        number(value.substr(0, 2)), number(value.substr(2)));
      break;
    case Step::hardware:
      if (number(value) != 0)
        return lose(fmt::format("{}: {}; switch it off and on", named(motion),
                                explain_hardware(static_cast<std::uint8_t>(number(value)))),
                    now);
      break;
    case Step::heat:
      if (too_hot(number(value))) return lose(trouble_, now);
      break;
    case Step::limit:
      motion.limit = std::min(motion.servo.max_current, number(value));
      motion.allowed = std::min(motion.allowed, motion.limit);
      break;
    case Step::mode:
      if (number(value) == current_based_position) step_ = Step::set_mode;  // is done
      break;
    case Step::place:
      if (const auto why = judge_place(answer)) return lose(*why, now);
      break;
    default:
      break;
  }
  return next_step(now);
}

/// A joint that is far outside its range is wired otherwise than the file says.
std::optional<std::string> Driver::judge_place(const Packet& answer) {
  Motion& motion = motions_[at_];
  motion.position = motion.goal = number(std::string_view(answer.parameters).substr(1));
  const model::HandDof& dof = hand_.dofs()[motion.servo.dof];
  const double value = motion.servo.dof_at(motion.position);
  const double slack = margin * model::radian_of(dof);
  if (value >= dof.lower - slack && value <= dof.upper + slack) return std::nullopt;
  return fmt::format("{} is at {:.3f}, outside its range; are zero and ratio right in {}?",
                     named(motion), value, options_.wiring_file);
}

std::string Driver::next_step(Time now) {
  const Step last = step_ < Step::speed ? Step::place : Step::watch;
  tries_ = 0;
  if (step_ != last) {
    step_ = static_cast<Step>(static_cast<int>(step_) + 1);
    return ask(now);
  }
  const bool all = ++at_ == motions_.size();
  if (all) at_ = 0;
  if (last == Step::place) {
    step_ = all ? Step::speed : Step::ping;
    if (all) be(Phase::homed);
    return ask(now);
  }
  step_ = Step::speed;
  if (!all) return ask(now);
  talk_ = Talk::looping;
  armed_ = true;
  waiting_ = false;
  tells_current_ = true;
  hot_ = false;
  phase_ = Phase::ready;
  checked_ = now;
  silence_.end(now);
  for (Motion& motion : motions_) motion.kept.forget();
  publish(now);
  return cycle(now);
}

// --- goals and places

std::string Driver::loop(Time now) {
  silence_.listen(now);
  // First of all: their watchdogs may have stopped them, though an answer has come meanwhile.
  if (now - silence_.began() > options_.lost_after) return lose(silence_.words(now), now);
  if (wants_home_) {
    wants_home_ = false;
    phase_ = Phase::homing;
    return stay() + begin(now);
  }
  if (waiting_)
    if (std::string said = take(now); !said.empty()) return said;
  for (const Motion& motion : motions_)
    if (stuck(motion)) return lose(named(motion) + " is stuck", now);
  if (waiting_ || now - asked_ < seconds(1 / options_.rate)) return {};
  return cycle(now);
}

std::string Driver::cycle(Time now) {
  std::string said;
  if (std::exchange(tells_current_, false))
    said += sync_write(table::goal_current, &Motion::allowed);
  said += sync_write(table::goal_position, &Motion::goal);
  asks_ = table::motion;
  if (now - checked_ > check_period) {
    checked_ = now;
    asks_ = check_ = check_ == table::temperature ? table::torque_enable : table::temperature;
  }
  said += sync_read(asks_);
  parser_.clear();
  for (std::string& answer : answers_) answer.clear();
  waiting_ = true;
  asked_ = now;
  return said;
}

/// The servos' answers, as they come.
std::string Driver::take(Time now) {
  const std::size_t size = asks_.size;
  while (const auto packet = parser_.next()) {
    if (packet->instruction != Instruction::status) continue;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      if (motions_[i].servo.id != packet->id || packet->parameters.empty()) continue;
      if ((static_cast<std::uint8_t>(packet->parameters[0]) & alert) != 0) {
        talk_ = Talk::explaining;
        at_ = i;
        asked_ = now;
        return encode({packet->id, Instruction::read, read_of(table::hardware_error)});
      }
      if (packet->parameters.size() == 1 + size) answers_[i] = packet->parameters.substr(1);
    }
  }
  const auto missing = std::find(answers_.begin(), answers_.end(), std::string());
  if (missing == answers_.end()) return accept(now);
  if (now - asked_ < due(answers_.size() * (status_bytes + size))) return {};
  count_reject("no answer");
  waiting_ = false;
  return {};
}

/// All have answered.
std::string Driver::accept(Time now) {
  waiting_ = false;
  if (asks_ == table::torque_enable) {
    silence_.end(now);
    for (std::size_t i = 0; i < motions_.size(); ++i)
      if (number(answers_[i]) == 0)
        return lose(named(motions_[i]) + " has lost its torque; was it switched off and on?", now);
    return {};
  }
  if (asks_ == table::temperature) {
    int hottest = 0;
    for (const std::string& answer : answers_) hottest = std::max(hottest, number(answer));
    silence_.end(now);
    return too_hot(hottest) ? lose(trouble_, now) : std::string();
  }
  if (!plausible(now)) {
    count_reject("garbled answer");
    return {};
  }
  for (std::size_t i = 0; i < motions_.size(); ++i) observe(motions_[i], answers_[i], now);
  silence_.end(now);
  publish(now);
  return {};
}

/// No servo is faster than four turns in a second; and a little, for the first look.
bool Driver::plausible(Time now) const {
  const double most = 300 + 4 * pulses_per_turn * to_seconds(now - silence_.began());
  for (std::size_t i = 0; i < motions_.size(); ++i)
    if (std::abs(number(std::string_view(answers_[i]).substr(6, 4)) - motions_[i].position) > most)
      return false;
  return true;
}

void Driver::observe(Motion& motion, const std::string& bytes, Time now) {
  const std::string_view view = bytes;
  motion.current = number(view.substr(0, 2));
  motion.velocity = pulses_per_second(number(view.substr(2, 4)));
  motion.position = number(view.substr(6, 4));
  const double radian =
      std::abs(motion.servo.pulses) * model::radian_of(hand_.dofs()[motion.servo.dof]);
  motion.kept.observe(std::abs(motion.goal - motion.position) < near * radian ||
                          std::abs(motion.velocity) > still * radian,
                      now);
}

bool Driver::stuck(const Motion& motion) const {
  const model::HandDof& dof = hand_.dofs()[motion.servo.dof];
  const double most = std::min(far * model::radian_of(dof), (dof.upper - dof.lower) / 3);
  return motion.kept.stuck() &&
         std::abs(motion.goal - motion.position) > most * std::abs(motion.servo.pulses);
}

void Driver::publish(Time now) {
  const auto count = static_cast<Eigen::Index>(motions_.size());
  Reading reading{now, Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count),
                  temperature_};
  for (const Motion& motion : motions_) {
    const auto d = static_cast<Eigen::Index>(motion.servo.dof);
    reading.dof[d] = motion.servo.dof_at(motion.position);
    reading.velocity[d] = motion.velocity / motion.servo.pulses;
    reading.effort[d] =
        std::copysign(1, motion.servo.pulses) * motion.current / motion.servo.current;
  }
  reading_ = std::move(reading);
}

std::string Driver::explain(Time now) {
  while (const auto packet = parser_.next())
    if (packet->id == motions_[at_].servo.id && packet->parameters.size() == 2)
      return lose(fmt::format("{}: {}; switch it off and on", named(motions_[at_]),
                              explain_hardware(static_cast<std::uint8_t>(packet->parameters[1]))),
                  now);
  if (now - asked_ < due(status_bytes + 1)) return {};
  return lose(named(motions_[at_]) + ": hardware error", now);
}

// --- what both parts need

/// Something is wrong: all stay where they were seen last, and are asked anew.
std::string Driver::lose(const std::string& why, Time now) {
  const std::string said = stay();
  be(identity_.empty() ? Phase::offline : Phase::faulted, why);
  talk_ = Talk::resting;
  asked_ = now;
  armed_ = wants_home_ = false;
  return said;
}

/// Once they have a torque: no servo goes on.
std::string Driver::stay() {
  if (!armed_) return {};
  for (Motion& motion : motions_) motion.goal = static_cast<int>(std::lround(motion.position));
  return sync_write(table::goal_position, &Motion::goal);
}

std::string Driver::sync_write(const Item& item, int Motion::*value) const {
  std::string parameters = read_of(item);
  for (const Motion& motion : motions_)
    parameters += static_cast<char>(motion.servo.id) + little_endian(motion.*value, item.size);
  return encode({broadcast, Instruction::sync_write, parameters});
}

std::string Driver::sync_read(const Item& item) const {
  std::string parameters = read_of(item);
  for (const Motion& motion : motions_) parameters += static_cast<char>(motion.servo.id);
  return encode({broadcast, Instruction::sync_read, parameters});
}

std::string Driver::named(const Motion& motion) const {
  return fmt::format("servo {} ({})", motion.servo.id, hand_.dofs()[motion.servo.dof].name);
}

/// Says what is wrong in trouble_.
bool Driver::too_hot(int celsius) {
  temperature_ =
      talk_ == Talk::looping ? celsius : std::max<double>(celsius, temperature_.value_or(0));
  const bool hot = celsius > options_.max_temperature - (hot_ ? cool : 0);
  hot_ |= hot;
  if (hot)
    trouble_ =
        fmt::format("too hot: {} °C, of at most {:.0f} °C", celsius, options_.max_temperature);
  return hot;
}

/// When so many bytes should have come.
Duration Driver::due(std::size_t bytes) const {
  return milliseconds(40) + seconds(20.0 * static_cast<double>(bytes + 64) / options_.baud);
}

}  // namespace prehend::robot::dynamixel
