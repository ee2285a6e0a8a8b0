#include "services/robot/core/barrett_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prehend::robot::barrett {
namespace {

constexpr double full_press = 0.4;         // rad/s of missing velocity: as hard as it can
constexpr double supervisory_speed = 1.5;  // rad/s
constexpr std::size_t max_line = 256;

bool is_movement(const std::string& command) {
  return command == "HI" || command == "HOME" || command == "O" || command == "C" || command == "M";
}

}  // namespace

Emulator::Emulator(const model::HandModel& hand, const EmulatedOptions& options)
    : options_(options) {
  for (std::size_t i = 0; i < motors; ++i) {
    motors_[i].initialized = options.initialized;
    if (!options.initialized) motors_[i].position = motors_[i].driven = max_counts(i) / 4.0;
    motors_[i].parameters = {{"LCV", 1},  {"LCVC", 1}, {"LCPG", 1},  {"LFV", 1},  {"LFS", 1},
                             {"LFAP", 1}, {"LFDP", 1}, {"MCV", 100}, {"MOV", 100}};
    squeeze_[i] = hand.dofs()[dof_of[i]].squeeze * counts_per_radian(i);
  }
  globals_ = {{"LFT", 0}};
}

// --- motion

std::string Emulator::pass(Duration now) {
  move(to_seconds(now - now_));
  now_ = now;
  if (mode_ != Mode::moving) return {};
  if (std::any_of(motors_.begin(), motors_.end(),
                  [](const Motor& motor) { return motor.target.has_value(); }))
    return {};
  mode_ = Mode::supervisory;
  return ready();
}

void Emulator::move(double dt) {
  for (std::size_t i = 0; i < motors; ++i) {
    Motor& motor = motors_[i];
    const double scale = counts_per_radian(i);
    double velocity = motor.velocity * options_.velocity_scale;
    if (motor.target) {
      const double way = *motor.target - motor.position;
      velocity = std::clamp(way / std::max(dt, 1e-3), -supervisory_speed * scale,
                            supervisory_speed * scale);
      if (std::abs(way) < 30 || motor.blocked) {
        motor.target.reset();
        motor.initialized |= std::exchange(motor.homing, false);
      }
    }
    const double top = max_counts(i);
    const double before = motor.driven;
    motor.driven = std::clamp(motor.driven + velocity * dt, 0.0, top);
    if (twin_) {
      // It presses by as much as velocity is missing, and its worm gear keeps that. The encoder is
      // the motor's, so that it does not wait for news of a joint that follows it freely.
      const double most = squeeze_[i] * std::min(1.0, std::abs(velocity) / (full_press * scale));
      if (velocity > 0)
        motor.driven = std::max(before, std::min(motor.driven, motor.joint + most));
      else if (velocity < 0)
        motor.driven = std::min(before, std::max(motor.driven, motor.joint - most));
      motor.position = motor.driven;
    } else if (!motor.blocked) {
      motor.position = motor.driven;
    } else {
      motor.driven = motor.position;
    }
  }
}

Eigen::VectorXd Emulator::driven() const {
  Eigen::VectorXd dof(motors);
  for (std::size_t i = 0; i < motors; ++i)
    dof[static_cast<Eigen::Index>(dof_of[i])] = motors_[i].driven / counts_per_radian(i);
  return dof;
}

Eigen::VectorXd Emulator::measured() const {
  Eigen::VectorXd dof(motors);
  for (std::size_t i = 0; i < motors; ++i)
    dof[static_cast<Eigen::Index>(dof_of[i])] = motors_[i].position / counts_per_radian(i);
  return dof;
}

void Emulator::measure(const Eigen::VectorXd& dof) {
  for (std::size_t i = 0; i < motors; ++i) {
    Motor& motor = motors_[i];
    if (motor.blocked) continue;
    motor.joint = dof[static_cast<Eigen::Index>(dof_of[i])] * counts_per_radian(i);
    if (!twin_) motor.driven = motor.position = motor.joint;
  }
  twin_ = true;
}

void Emulator::block(std::size_t dof, bool blocked) {
  for (std::size_t i = 0; i < motors; ++i)
    if (dof_of[i] == dof) motors_[i].blocked = blocked;
}

void Emulator::restart() {
  (void)break_off();
  for (Motor& motor : motors_) motor.initialized = false;
}

// --- supervisory mode

std::string Emulator::receive(std::string_view bytes, Duration now) {
  std::string answer = pass(now);
  for (const char c : bytes) {
    // Within a block it is a velocity like another.
    if (c == abort_key && block_.empty())
      answer += break_off();
    else if (mode_ == Mode::realtime)
      answer += realtime(c);
    else if (mode_ == Mode::moving)
      continue;  // it does not listen
    else if (c == end_of_line)
      answer += line(std::exchange(line_, {}));
    else if (line_.size() < max_line && c != '\n')
      line_ += c;
  }
  return answer;
}

std::string Emulator::ready(int error) const {
  return (error != 0 ? "\r\nERR " + std::to_string(error) : std::string()) + "\r\n" +
         std::string(prompt);
}

std::string Emulator::break_off() {
  line_.clear();
  block_.clear();
  for (Motor& motor : motors_) {
    motor.velocity = 0;
    motor.target.reset();
    motor.homing = false;
  }
  const bool was_busy = std::exchange(mode_, Mode::supervisory) != Mode::supervisory;
  return ready(was_busy ? aborted : 0);
}

std::string Emulator::line(const std::string& text) {
  if (text.empty()) return ready();
  std::size_t end = 0;
  while (end < text.size() && (std::isdigit(static_cast<unsigned char>(text[end])) != 0 ||
                               ((text[end] == 'S' || text[end] == 'G') && end + 1 < text.size())))
    ++end;
  const auto named = motors_of(std::string_view(text).substr(0, end));
  std::vector<std::string> words = words_of(text.substr(end));
  if (!named || words.empty()) return ready(unknown_command);
  const std::string command = words.front();
  words.erase(words.begin());
  if (command == "PGET" || command == "PSET" || command == "VERS" || command == "RESET")
    return end > 0 ? ready(no_motor_prefix) : global(command, words);
  return execute(*named, command, words);
}

std::string Emulator::execute(unsigned named, const std::string& command,
                              const std::vector<std::string>& arguments) {
  if (is_movement(command)) return begin(named, command, arguments);
  if (command == "FSET") return set(named, arguments);
  if (command == "FGET") return get(named, arguments);
  if (command == "T") {
    for (Motor& motor : motors_) motor.target.reset();
    return ready();
  }
  if (command != "LOOP") return ready(unknown_command);
  for (const Motor& motor : motors_)
    if (!motor.initialized) return ready(not_initialized);
  if (named != 0b1111u) return ready(invalid_value);  // this one only does all
  mode_ = Mode::realtime;
  block_.clear();
  return {acknowledgement};
}

std::string Emulator::begin(unsigned named, const std::string& command,
                            const std::vector<std::string>& arguments) {
  std::optional<int> place;
  if (command == "M") {
    if (arguments.empty()) return ready(invalid_value);
    place = number_of(arguments.front());
    if (!place || *place < 0) return ready(invalid_value);
  }
  for (std::size_t i = 0; i < motors; ++i) {
    Motor& motor = motors_[i];
    if ((named & 1u << i) == 0) continue;
    if (command != "HI" && !motor.initialized) return ready(not_initialized);
    motor.target = command == "C" ? max_counts(i) : std::min(place.value_or(0), max_counts(i));
    motor.velocity = 0;
    motor.homing = command == "HI";
    if (motor.homing) motor.initialized = false;
  }
  mode_ = Mode::moving;
  return {};
}

std::string Emulator::set(unsigned named, const std::vector<std::string>& arguments) {
  if (arguments.size() % 2 != 0 || arguments.empty()) return ready(invalid_value);
  for (std::size_t k = 0; k < arguments.size(); k += 2) {
    const auto value = number_of(arguments[k + 1]);
    if (!value || *value < 0 || *value > 20000) return ready(invalid_value);
    for (std::size_t i = 0; i < motors; ++i) {
      const auto found = motors_[i].parameters.find(arguments[k]);
      if (found == motors_[i].parameters.end()) return ready(unknown_parameter);
      if ((named & 1u << i) != 0) found->second = *value;
    }
  }
  return ready();
}

std::string Emulator::get(unsigned named, const std::vector<std::string>& arguments) const {
  if (arguments.size() != 1) return ready(invalid_value);
  std::string text;
  for (std::size_t i = 0; i < motors; ++i) {
    if ((named & 1u << i) == 0) continue;
    const Motor& motor = motors_[i];
    const auto found = motor.parameters.find(arguments.front());
    int value = 0;
    if (arguments.front() == "P")
      value = static_cast<int>(std::lround(motor.position));
    else if (arguments.front() == "S")
      value = motor.initialized ? 0 : not_initialized;
    else if (arguments.front() == "SG")
      value = no_gauge;
    else if (found != motor.parameters.end())
      value = found->second;
    else
      return ready(unknown_parameter);
    text += (text.empty() ? "" : " ") + std::to_string(value);
  }
  return text + ready();
}

std::string Emulator::global(const std::string& command,
                             const std::vector<std::string>& arguments) {
  if (command == "VERS") return "BarrettHand BH8-262, emulated by prehend" + ready();
  if (command == "RESET") {
    for (Motor& motor : motors_) motor.initialized = false;
    return ready();
  }
  const bool gets = command == "PGET";
  if (arguments.size() != (gets ? 1 : 2)) return ready(invalid_value);
  if (gets && arguments.front() == "TEMP")
    return std::to_string(std::lround(temperature_ * 10)) + ready();
  const auto found = globals_.find(arguments.front());
  if (found == globals_.end()) return ready(unknown_parameter);
  if (gets) return std::to_string(found->second) + ready();
  const auto value = number_of(arguments[1]);
  if (!value) return ready(invalid_value);
  found->second = *value;
  return ready();
}

// --- RealTime mode

std::size_t Emulator::control_size() const {
  std::size_t size = 0;
  for (const Motor& motor : motors_)
    size +=
        (motor.parameters.at("LCV") != 0 ? 1u : 0u) + (motor.parameters.at("LCPG") != 0 ? 1u : 0u);
  return size;
}

int Emulator::feedback_temperature() const {
  return globals_.at("LFT") != 0 ? options_.temperature_bytes : 0;
}

std::string Emulator::realtime(char byte) {
  block_ += byte;
  const char header = block_.front();
  const bool controls = header == 'C' || header == 'c';
  if (!controls && header != 'A' && header != 'a') {
    break_off();
    return ready(invalid_header);
  }
  if (block_.size() < 1 + (controls ? control_size() : 0)) return {};
  return block_done();
}

std::string Emulator::block_done() {
  const std::string block = std::exchange(block_, {});
  std::size_t at = 1;
  for (std::size_t i = 0; i < motors && block.size() > 1; ++i) {
    const auto& parameters = motors_[i].parameters;
    if (parameters.at("LCV") != 0)
      motors_[i].velocity =
          static_cast<signed char>(block[at++]) * parameters.at("LCVC") * 1000.0 / 16;
    if (parameters.at("LCPG") != 0) ++at;
  }
  if (temperature_ > 100) {  // its own limit
    break_off();
    return ready(over_temperature);
  }
  std::string answer{acknowledgement};
  if (block.front() == 'c' || block.front() == 'a') return answer;
  for (const Motor& motor : motors_) {
    const int position = std::max(0, static_cast<int>(std::lround(motor.position)));
    const auto& parameters = motor.parameters;
    if (parameters.at("LFV") != 0)
      answer += static_cast<char>(std::clamp(static_cast<int>(motor.velocity / 1000), -128, 127));
    if (parameters.at("LFS") != 0) answer += static_cast<char>(no_gauge);
    if (parameters.at("LFAP") != 0) {
      answer += static_cast<char>(position >> 8 & 0xff);
      answer += static_cast<char>(position & 0xff);
    }
    if (parameters.at("LFDP") != 0) answer += '\0';
  }
  const long tenths = std::lround(temperature_ * 10);
  if (feedback_temperature() == 1) answer += static_cast<char>(std::lround(temperature_));
  if (feedback_temperature() == 2) {
    answer += static_cast<char>(tenths >> 8 & 0xff);
    answer += static_cast<char>(tenths & 0xff);
  }
  return answer;
}

}  // namespace prehend::robot::barrett
