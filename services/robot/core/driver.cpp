#include "services/robot/core/driver.hpp"

#include "services/robot/core/barrett_driver.hpp"
#include "services/robot/core/dynamixel_driver.hpp"
#include "services/robot/core/inspire_driver.hpp"
#include "services/robot/core/robotiq_driver.hpp"
#include "services/robot/core/ros2_control_driver.hpp"

namespace prehend::robot {

std::string_view to_string(Phase phase) {
  switch (phase) {
    case Phase::offline:
      return "offline";
    case Phase::configured:
      return "configured";
    case Phase::homing:
      return "homing";
    case Phase::homed:
      return "homed";
    case Phase::ready:
      return "ready";
    case Phase::faulted:
      return "faulted";
  }
  return "unknown";
}

const std::vector<DriverKind>& driver_kinds() {
  static const std::vector<DriverKind> kinds{
      {"barrett", "barrett", "", Medium::serial, 9600, "BarrettHand BH8-262, RS-232",
       barrett::create},
      {"dynamixel", "", "dynamixel.toml", Medium::serial, 57600,
       "servos of protocol 2.0 on one line", dynamixel::create},
      {"robotiq_2f85", "robotiq_2f85", "", Medium::serial, 115200, "Robotiq 2F-85, Modbus RTU",
       robotiq::create_2f85},
      {"robotiq_2f140", "robotiq_2f140", "", Medium::serial, 115200, "Robotiq 2F-140, Modbus RTU",
       robotiq::create_2f140},
      {"inspire_rh56", "inspire_rh56", "", Medium::serial, 115200, "Inspire RH56, its own frames",
       inspire::create},
      {"ros2_control", "", "", Medium::topics, 0, "a controller manager of ROS 2, by DDS",
       ros2_control::create},
  };
  return kinds;
}

Expected<const DriverKind*> find_driver(std::string_view name) {
  std::string names;
  for (const DriverKind& kind : driver_kinds()) {
    if (kind.name == name) return &kind;
    names += (names.empty() ? "" : " or ") + std::string(kind.name);
  }
  return wrong_use("there is no driver '" + std::string(name) + "'", "robot.device",
                   "give " + names);
}

}  // namespace prehend::robot
