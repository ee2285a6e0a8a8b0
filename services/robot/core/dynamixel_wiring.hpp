#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::robot::dynamixel {

/// Which servo moves a DoF, and how.
struct Servo {
  std::uint8_t id = 1;
  std::size_t dof = 0;
  double zero = 0;      // pulses, where the DoF is 0
  double pulses = 1;    // per rad or m of the DoF; negative: the other way round
  double current = 1;   // units of current per N m or N of the DoF
  int max_current = 0;  // units of current

  double position_of(double dof_value) const { return zero + pulses * dof_value; }
  double dof_at(double position) const { return (position - zero) / pulses; }
};

/// The servos of a hand, in the order of its DoFs, from dynamixel.toml: each DoF has one.
Expected<std::vector<Servo>> parse_wiring(std::string_view toml, const model::HandModel& hand,
                                          const std::string& file);

}  // namespace prehend::robot::dynamixel
