#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "services/robot/core/emulator.hpp"
#include "services/robot/core/modbus_rtu.hpp"
#include "services/robot/core/robotiq_gripper.hpp"

namespace prehend::robot::robotiq {

Expected<std::unique_ptr<robot::Emulator>> emulate_2f85(const model::HandModel& hand,
                                                        const EmulatedOptions& options);
Expected<std::unique_ptr<robot::Emulator>> emulate_2f140(const model::HandModel& hand,
                                                         const EmulatedOptions& options);

/// A gripper as a device on a line of Modbus.
class Emulator final : public robot::Emulator {
 public:
  Emulator(const model::HandModel& hand, const Kind& kind, const EmulatedOptions& options);

  std::string receive(std::string_view bytes, Duration now) override;
  std::string pass(Duration now) override;
  Eigen::VectorXd driven() const override {
    return Eigen::VectorXd::Constant(1, gripper_.driven());
  }
  Eigen::VectorXd measured() const override {
    return Eigen::VectorXd::Constant(1, gripper_.measured());
  }
  void measure(const Eigen::VectorXd& dof) override { gripper_.measure(dof[0]); }
  void block(std::size_t, bool blocked) override { gripper_.block(blocked); }
  void heat(double celsius) override { gripper_.heat(celsius); }
  void restart() override { gripper_.restart(); }
  /// From now on it answers with this id.
  void answer_as(std::uint8_t id) { answers_as_ = id; }

 private:
  Gripper gripper_;
  std::uint8_t id_, answers_as_;
  modbus::Parser parser_{modbus::Side::asks};
  Duration heard_{};
};

}  // namespace prehend::robot::robotiq
