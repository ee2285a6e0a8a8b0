#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/robot/core/dynamixel_protocol.hpp"
#include "services/robot/core/dynamixel_wiring.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot::dynamixel {

/// The servos of a hand on one line: X series, switched on with their torque off. Each keeps its
/// control table, stops by its watchdog, and lets go when it is too hot, until a reboot.
class Emulator final : public robot::Emulator {
 public:
  Emulator(const model::HandModel& hand, const std::vector<Servo>& servos,
           const EmulatedOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::string pass(Duration now) override;
  Eigen::VectorXd driven() const override;
  Eigen::VectorXd measured() const override;
  void measure(const Eigen::VectorXd& dof) override;
  void block(std::size_t dof, bool blocked) override;
  void heat(double celsius) override;
  void restart() override;

 private:
  struct Unit {
    Servo servo;
    double squeeze = 0, full = 1;  // pulses past a contact, by which it presses with this current
    double moving = 0;             // pulses/s, from which on it does not press
    double position = 0, driven = 0;  // pulses
    double seen = 0, velocity = 0;    // pulses, pulses/s
    bool blocked = false;
    std::array<std::uint8_t, table::size> bytes{};
    Duration heard{};  // any instruction, for its watchdog

    std::int32_t get(const Item& item) const;
    void set(const Item& item, std::int64_t value);
    double goal() const;
  };

  void move(Unit& unit, double dt) const;
  std::string execute(const Packet& packet);
  std::string answer(Unit& unit, const Packet& packet);
  std::string status(const Unit& unit, std::uint8_t error, std::string_view parameters = {}) const;
  std::uint8_t write(Unit& unit, std::string_view parameters) const;
  std::string sync(const Packet& packet);
  void reboot(Unit& unit) const;
  void shut_down(Unit& unit) const;

  EmulatedOptions options_;
  std::vector<Unit> units_;
  Parser parser_;
  bool twin_ = false;
  Duration now_{}, heard_{};
};

}  // namespace prehend::robot::dynamixel
