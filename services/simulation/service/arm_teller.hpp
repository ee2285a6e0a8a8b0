#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/carrying/carrying_arm.hpp"
#include "common/service/config.hpp"
#include "common/service/shell.hpp"
#include "idl/Arm.h"
#include "services/simulation/core/command.hpp"

namespace prehend::simulation {

/// The arm of the configuration, with the hand on it; nothing where there is none.
Expected<std::unique_ptr<carrying::CarryingArm>> arm_of(const service::Config& config,
                                                        const model::HandModel& hand);

/// Says what the arm is told and does: arm/command, arm/state, and in the status why the hand is
/// not where it is wished.
class ArmTeller {
 public:
  ArmTeller(service::Shell& shell, const carrying::CarryingArm& arm);

  /// command: that is followed, if any.
  void tell(const carrying::ArmMotion& motion, const std::optional<Command>& command, Time now);

 private:
  void complain(const carrying::ArmMotion& motion, Time now);

  service::Shell& shell_;
  const carrying::CarryingArm& arm_;
  service::Shell::Output<v1::ArmCommand> commands_;
  service::Shell::Output<v1::ArmState> states_;
  v1::ArmCommand command_;
  v1::ArmState state_;
  std::optional<arm::Joints> joint_;  // of the last state
  Time told_{};
  bool is_troubled_ = false, said_ = false;
  Time since_{};  // when that began or ended
};

}  // namespace prehend::simulation
