#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/robot/core/modbus_rtu.hpp"

/// Registers of Robotiq's grippers of two fingers, and what their bytes mean. Facts and their
/// sources: services/robot/core/README.md.
namespace prehend::robot::robotiq {

/// What differs between them.
struct Kind {
  std::string_view name;        // as of their hand
  std::string_view title;       // as sold
  double opening;               // m
  double min_force, max_force;  // N, of a pad
  double min_speed, max_speed;  // m/s, of the opening
};
inline constexpr Kind kind_2f85{"robotiq_2f85", "Robotiq 2F-85", 0.085, 20, 235, 0.02, 0.15};
inline constexpr Kind kind_2f140{"robotiq_2f140", "Robotiq 2F-140", 0.14, 10, 125, 0.03, 0.25};

inline constexpr std::uint8_t usual_id = 9;
inline constexpr std::uint16_t action_at = 0x03e8, status_at = 0x07d0;
inline constexpr std::uint16_t register_count = 3;        // of both
inline constexpr int open_count = 3, closed_count = 230;  // where a healthy one ends

/// Bits of the action's high byte, and of the status'.
enum Bit : std::uint8_t { active = 1, goes = 8, releases = 16 };

struct Action {
  std::uint8_t bits = 0, position = 0, speed = 0, force = 0;
  bool operator==(const Action&) const = default;
};
modbus::Registers encode(const Action& action);
Action action_of(const modbus::Registers& registers);

enum class Activation : std::uint8_t { reset = 0, busy = 1, done = 3 };
enum class Object : std::uint8_t { moving = 0, while_opening = 1, while_closing = 2, none = 3 };

struct Status {
  std::uint8_t bits = 0;  // active and goes
  Activation activation = Activation::reset;
  Object object = Object::moving;
  std::uint8_t fault = 0, goal = 0, position = 0, current = 0;  // current: 10 mA
  bool operator==(const Status&) const = default;
};
modbus::Registers encode(const Status& status);
Status status_of(const modbus::Registers& registers);

enum Fault : std::uint8_t {
  needs_activation = 5,
  no_activation = 7,
  hot = 8,
  unheard = 9,
  releasing = 11,
  overcurrent = 14
};
std::string explain_fault(std::uint8_t fault);
/// Only an activation ends it.
bool ends_activation(std::uint8_t fault);

/// Counts and what they are of a hand: of its DoF, and of the share of its effort.
class Scale {
 public:
  Scale(const model::HandModel& hand, const Kind& kind);
  double dof_of(double count) const;
  double count_of(double dof) const;              // not rounded
  double counts(double way) const;                // of a way of the DoF
  std::uint8_t force_count(double effort) const;  // N m of the DoF
  double effort_of(std::uint8_t force) const;
  std::uint8_t speed_count(double velocity) const;  // rad/s of the DoF
  double velocity_of(std::uint8_t speed) const;
  double max_effort() const { return max_effort_; }

 private:
  Kind kind_;
  double lower_, range_, max_effort_;
  double meters_;  // of the opening per unit of the DoF
};

/// Refuses a hand that is not one motor's.
Expected<void> check_hand(const model::HandModel& hand, const Kind& kind);

}  // namespace prehend::robot::robotiq
