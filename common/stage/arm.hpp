#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/arm_model.hpp"
#include "common/service/config.hpp"
#include "idl/Arm.h"

namespace prehend::stage {

/// The arm of robot.arm, which can carry the hand of simulation.hand; nothing: the hand flies.
Expected<std::optional<model::ArmModel>> carrying_arm(const service::Config& config);

/// What a play asked of the arm that carries the hand.
class ArmUse {
 public:
  explicit ArmUse(const model::ArmModel& arm);

  void hear(const v1::ArmState& state);
  const std::string& name() const { return name_; }
  /// The largest, as a share of its joint's limit.
  double worst_joint_speed() const { return worst_; }
  /// Share of the states in which a limit, something in the way or its reach hindered it.
  double out_of_reach() const;

 private:
  std::string name_;
  std::vector<double> speeds_;  // that joints may have, rad/s
  double worst_ = 0;
  std::uint64_t states_ = 0, hindered_ = 0;
};

}  // namespace prehend::stage
