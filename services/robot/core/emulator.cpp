#include "services/robot/core/emulator.hpp"

#include "services/robot/core/barrett_emulator.hpp"
#include "services/robot/core/dynamixel_emulator.hpp"
#include "services/robot/core/inspire_emulator.hpp"
#include "services/robot/core/robotiq_emulator.hpp"
#include "services/robot/core/ros2_control_emulator.hpp"

namespace prehend::robot {

namespace {

Expected<std::unique_ptr<Emulator>> barrett_hand(const model::HandModel& hand,
                                                 const EmulatedOptions& options) {
  return std::make_unique<barrett::Emulator>(hand, options);
}

Expected<std::unique_ptr<Emulator>> dynamixel_servos(const model::HandModel& hand,
                                                     const EmulatedOptions& options) {
  const auto servos = dynamixel::parse_wiring(options.wiring, hand, options.wiring_file);
  if (!servos) return tl::unexpected(servos.error());
  return std::make_unique<dynamixel::Emulator>(hand, *servos, options);
}

Expected<std::unique_ptr<Emulator>> controllers(const model::HandModel& hand,
                                                const EmulatedOptions& options) {
  return std::make_unique<ros2_control::Emulator>(hand, options);
}

}  // namespace

const std::vector<EmulatorKind>& emulator_kinds() {
  static const std::vector<EmulatorKind> kinds{
      {"barrett", "barrett", "", barrett_hand, Medium::serial, 38400},
      {"dynamixel", "", "dynamixel.toml", dynamixel_servos, Medium::serial, 1000000},
      {"robotiq_2f85", "robotiq_2f85", "", robotiq::emulate_2f85, Medium::serial, 115200},
      {"robotiq_2f140", "robotiq_2f140", "", robotiq::emulate_2f140, Medium::serial, 115200},
      {"inspire_rh56", "inspire_rh56", "", inspire::emulate, Medium::serial, 115200},
      {"ros2_control", "", "", controllers, Medium::topics, 0},
  };
  return kinds;
}

Expected<const EmulatorKind*> find_emulator(std::string_view name) {
  std::string names;
  for (const EmulatorKind& kind : emulator_kinds()) {
    if (kind.name == name) return &kind;
    names += (names.empty() ? "" : " or ") + std::string(kind.name);
  }
  return wrong_use("there is no emulator '" + std::string(name) + "'", "--device", "give " + names);
}

}  // namespace prehend::robot
