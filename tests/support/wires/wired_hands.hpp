#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/driver.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::test {

inline constexpr Duration robot_tick = std::chrono::milliseconds(2);  // of prehend-robot

/// A servo for each DoF of any hand, every second one mounted the other way round: as
/// dynamixel.toml says it.
std::string servo_wiring(const model::HandModel& hand);

/// What is played at the end of a wire: a kind of driver, and the hand that it drives.
struct WiredHand {
  std::string driver;  // as robot.device
  std::string hand;    // as mapping.hand

  /// Both ends. Throw when they cannot be made.
  std::unique_ptr<robot::Driver> near(robot::DriverOptions options) const;
  std::unique_ptr<robot::Emulator> far(robot::EmulatedOptions options = {}) const;
  robot::Medium medium() const;
  int baud() const;  // at which its emulator speaks; 0: topics
};

/// One of each driver: barrett, dynamixel (twelve servos), robotiq_2f85, inspire_rh56,
/// ros2_control.
const std::vector<WiredHand>& wired_hands();

}  // namespace prehend::test
