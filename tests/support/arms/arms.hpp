#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/arm/kinematics.hpp"
#include "common/base/random.hpp"
#include "common/model/arm_model.hpp"

namespace prehend::test {

/// The two files of an arm.
struct ArmFiles {
  std::string name, urdf, toml;
};

/// Arms in the manner of today's, by their public dimensions: `offset_wrist` as a UR5, whose wrist
/// axes do not meet, `seven_offset` as a Panda, `seven_round` as an iiwa.
const std::vector<ArmFiles>& foreign_arms();

/// Those and the arms of the source tree.
std::vector<ArmFiles> all_arms();

/// One of them, loaded once. Throws when it cannot be loaded.
const model::ArmModel& arm(std::string_view name);
std::vector<std::string> arm_names();

/// A posture within the limits.
arm::Joints random_posture(const model::ArmModel& arm, Random& random);

/// By how much the joint turns that turns most from a to b, rad; a whole turn is none.
double turn_distance(const arm::Joints& a, const arm::Joints& b);

}  // namespace prehend::test
