#include "services/robot/core/dynamixel_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prehend::robot::dynamixel {
namespace {

constexpr int model_number = 1240;  // XC330-M288
constexpr int firmware = 46;
constexpr Item number_of_model{0, 2}, number_of_firmware{6, 1}, own_id{7, 1};
constexpr std::uint16_t first_of_ram = 64;
constexpr Duration gap = std::chrono::milliseconds(50);  // a packet has no longer pause
constexpr double smoothing = 0.02;                       // s, of its velocity
constexpr double fastest = 1.7 * pulses_per_turn;        // pulses/s

/// All that a host may write, with its range.
struct Writable {
  Item item;
  std::int32_t lower, upper;
};
constexpr std::array writables{Writable{table::operating_mode, 0, 16},
                               Writable{table::temperature_limit, 0, 100},
                               Writable{table::current_limit, 0, 2352},
                               Writable{table::torque_enable, 0, 1},
                               Writable{table::status_return, 0, 2},
                               Writable{table::watchdog, 0, 127},
                               Writable{table::goal_current, -2352, 2352},
                               Writable{table::profile_velocity, 0, 32767},
                               Writable{table::goal_position, -max_pulses, max_pulses}};

bool is_goal(const Item& item) {
  return item.address >= 100 && item.address < 120 &&
         item.address != table::profile_velocity.address;
}

}  // namespace

std::int32_t Emulator::Unit::get(const Item& item) const {
  return number({reinterpret_cast<const char*>(bytes.data()) + item.address, item.size});
}

void Emulator::Unit::set(const Item& item, std::int64_t value) {
  const std::string text = little_endian(value, item.size);
  std::copy(text.begin(), text.end(), bytes.begin() + item.address);
}

double Emulator::Unit::goal() const {
  return get(table::goal_position);
}

Emulator::Emulator(const model::HandModel& hand, const std::vector<Servo>& servos,
                   const EmulatedOptions& options)
    : options_(options) {
  for (const Servo& servo : servos) {
    Unit unit;
    unit.servo = servo;
    const model::HandDof& dof = hand.dofs()[servo.dof];
    const double torque = hand.joints()[static_cast<std::size_t>(dof.joint)].max_torque;
    unit.squeeze = std::abs(dof.squeeze * servo.pulses);
    unit.full = std::max(1.0, torque * servo.current);
    unit.moving = 0.05 * model::radian_of(dof) * std::abs(servo.pulses);
    unit.position = unit.driven = unit.seen =
        servo.position_of(hand.postures().at("open")[static_cast<Eigen::Index>(servo.dof)]);
    unit.set(table::operating_mode, 3);
    unit.set(table::temperature_limit, 70);
    unit.set(table::current_limit, 2352);
    unit.set(table::temperature, 32);
    unit.set(table::status_return, 2);
    reboot(unit);
    units_.push_back(unit);
  }
}

/// What is lost with the power is as it was at first.
void Emulator::reboot(Unit& unit) const {
  unit.set(number_of_model, model_number);
  unit.set(number_of_firmware, firmware);
  unit.set(own_id, unit.servo.id);
  unit.set(table::torque_enable, 0);
  unit.set(table::hardware_error, 0);
  unit.set(table::watchdog, 0);
  unit.set(table::profile_velocity, 0);
  unit.set(table::goal_current, unit.get(table::current_limit));
  unit.set(table::goal_position, std::lround(unit.position));
}

void Emulator::shut_down(Unit& unit) const {
  unit.set(table::hardware_error, unit.get(table::hardware_error) | overheated);
  unit.set(table::torque_enable, 0);
}

// --- motion

std::string Emulator::pass(Duration now) {
  const double dt = to_seconds(now - now_);
  now_ = now;
  if (!parser_.is_empty() && now - heard_ > gap) parser_.clear();
  for (Unit& unit : units_) {
    const int watch = unit.get(table::watchdog);
    if (unit.get(table::torque_enable) != 0 && watch > 0 && watch < watchdog_bit &&
        now - unit.heard > std::chrono::milliseconds(watchdog_unit_ms) * watch) {
      unit.set(table::watchdog, watchdog_bit);
      unit.set(table::goal_position, std::lround(unit.position));
    }
    if (unit.get(table::temperature) > unit.get(table::temperature_limit)) shut_down(unit);
    move(unit, dt);
    unit.set(table::present_position, std::lround(unit.position));
    unit.set(table::present_velocity,
             std::lround(unit.velocity / (velocity_unit / 60 * pulses_per_turn)));
  }
  return {};
}

void Emulator::move(Unit& unit, double dt) const {
  const bool on = unit.get(table::torque_enable) != 0;
  const int limit = unit.get(table::profile_velocity);
  const double speed =
      limit == 0 ? fastest : std::min(fastest, limit * velocity_unit / 60 * pulses_per_turn);
  if (on) {
    const double step = speed * dt * options_.velocity_scale;
    unit.driven += std::clamp(unit.goal() - unit.driven, -step, step);
    // What is in its way it presses against with its current, whatever its goal is.
    const double share = std::clamp(unit.get(table::goal_current) / unit.full, 0.0, 1.0);
    const double most = unit.squeeze * (std::abs(unit.velocity) > unit.moving ? 1 : share);
    if (twin_ || unit.blocked)
      unit.driven = unit.position + std::clamp(unit.driven - unit.position, -most, most);
  } else {
    unit.driven = unit.position;
  }
  if (!twin_ && !unit.blocked) unit.position = unit.driven;
  const double way = unit.position - std::exchange(unit.seen, unit.position);
  unit.velocity += (way - unit.velocity * dt) / (dt + smoothing);
  const double presses = (unit.driven - unit.position) / unit.squeeze;
  unit.set(table::present_current, std::lround(std::clamp(presses, -1.0, 1.0) * unit.full));
}

Eigen::VectorXd Emulator::driven() const {
  Eigen::VectorXd dof(static_cast<Eigen::Index>(units_.size()));
  for (const Unit& unit : units_)
    dof[static_cast<Eigen::Index>(unit.servo.dof)] = unit.servo.dof_at(unit.driven);
  return dof;
}

Eigen::VectorXd Emulator::measured() const {
  Eigen::VectorXd dof(static_cast<Eigen::Index>(units_.size()));
  for (const Unit& unit : units_)
    dof[static_cast<Eigen::Index>(unit.servo.dof)] = unit.servo.dof_at(unit.position);
  return dof;
}

void Emulator::measure(const Eigen::VectorXd& dof) {
  for (Unit& unit : units_)
    if (!unit.blocked)
      unit.position = unit.servo.position_of(dof[static_cast<Eigen::Index>(unit.servo.dof)]);
  twin_ = true;
}

void Emulator::block(std::size_t dof, bool blocked) {
  for (Unit& unit : units_)
    if (unit.servo.dof == dof) unit.blocked = blocked;
}

void Emulator::heat(double celsius) {
  for (Unit& unit : units_) unit.set(table::temperature, std::lround(celsius));
}

void Emulator::restart() {
  for (Unit& unit : units_) reboot(unit);
}

// --- what is said

std::string Emulator::receive(std::string_view bytes, Duration now) {
  pass(now);
  heard_ = now;
  parser_.feed(bytes);
  std::string said;
  while (const auto packet = parser_.next())
    if (packet->instruction != Instruction::status) said += execute(*packet);
  return said;
}

std::string Emulator::execute(const Packet& packet) {
  std::string said;
  for (Unit& unit : units_) unit.heard = now_;
  if (packet.instruction == Instruction::sync_read || packet.instruction == Instruction::sync_write)
    return sync(packet);
  for (Unit& unit : units_)
    if (packet.id == unit.servo.id || packet.id == broadcast) {
      std::string answered = answer(unit, packet);
      if (packet.id != broadcast || packet.instruction == Instruction::ping) said += answered;
    }
  return said;
}

std::string Emulator::answer(Unit& unit, const Packet& packet) {
  const std::string_view parameters = packet.parameters;
  switch (packet.instruction) {
    case Instruction::ping:
      return status(unit, 0, little_endian(model_number, 2) + little_endian(firmware, 1));
    case Instruction::read: {
      if (parameters.size() != 4) return status(unit, length_error);
      const auto address = static_cast<std::size_t>(number(parameters.substr(0, 2)) & 0xffff);
      const auto size = static_cast<std::size_t>(number(parameters.substr(2, 2)) & 0xffff);
      if (address + size > table::size || size == 0) return status(unit, access_error);
      return status(unit, 0, {reinterpret_cast<const char*>(unit.bytes.data()) + address, size});
    }
    case Instruction::write: {
      const std::uint8_t error = write(unit, parameters);
      return unit.get(table::status_return) == 2 ? status(unit, error) : std::string();
    }
    case Instruction::reboot:
      reboot(unit);
      return status(unit, 0);
    default:
      return status(unit, instruction_error);
  }
}

std::string Emulator::status(const Unit& unit, std::uint8_t error,
                             std::string_view parameters) const {
  if (unit.get(table::hardware_error) != 0) error |= alert;
  std::string all(1, static_cast<char>(error));
  all += parameters;
  return encode({unit.servo.id, Instruction::status, all});
}

/// A whole item at a time.
std::uint8_t Emulator::write(Unit& unit, std::string_view parameters) const {
  if (parameters.size() < 3) return length_error;
  const auto address = static_cast<std::uint16_t>(number(parameters.substr(0, 2)));
  const std::string_view value = parameters.substr(2);
  const auto found = std::find_if(writables.begin(), writables.end(), [&](const Writable& known) {
    return known.item.address == address;
  });
  if (found == writables.end()) return access_error;
  if (value.size() != found->item.size) return length_error;
  if (address < first_of_ram && unit.get(table::torque_enable) != 0) return access_error;
  if (number(value) < found->lower || number(value) > found->upper) return range_error;
  if (is_goal(found->item) && unit.get(table::watchdog) == watchdog_bit) return range_error;
  if (address == table::goal_current.address &&
      std::abs(number(value)) > unit.get(table::current_limit))
    return range_error;
  // One that has shut itself down stays so.
  if (address == table::torque_enable.address && unit.get(table::hardware_error) != 0) return 0;
  unit.set(found->item, number(value));
  return 0;
}

std::string Emulator::sync(const Packet& packet) {
  const std::string_view parameters = packet.parameters;
  if (packet.id != broadcast || parameters.size() < 4) return {};
  const std::string_view address = parameters.substr(0, 2);
  const auto size = static_cast<std::size_t>(number(parameters.substr(2, 2)) & 0xffff);
  const bool writes = packet.instruction == Instruction::sync_write;
  const std::size_t each = writes ? 1 + size : 1;
  std::string said;
  for (std::size_t at = 4; at + each <= parameters.size(); at += each)
    for (Unit& unit : units_) {
      if (unit.servo.id != static_cast<std::uint8_t>(parameters[at])) continue;
      if (writes)
        (void)write(unit, std::string(address) + std::string(parameters.substr(at + 1, size)));
      else
        said +=
            answer(unit, {unit.servo.id, Instruction::read, std::string(parameters.substr(0, 4))});
    }
  return said;
}

}  // namespace prehend::robot::dynamixel
