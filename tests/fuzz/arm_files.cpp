#include "tests/fuzz/arm_files.hpp"

#include "common/arm/collision.hpp"
#include "common/arm/inverse.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/arms/arms.hpp"

namespace prehend::fuzz {

void require_sound(const model::ArmModel& arm) {
  require(arm.joints.size() == 6 || arm.joints.size() == 7, "neither six nor seven joints");
  require(arm.links.size() == arm.joints.size() + 1, "links and joints do not agree");
  require(arm.home.allFinite() && arm::is_within_limits(arm, arm.home), "home is outside");
  for (const model::ArmJoint& joint : arm.joints)
    require(joint.lower < joint.upper && joint.velocity > 0 && joint.acceleration > 0,
            "limits allow nothing");
  Random random(1);
  const arm::Collision collision(arm, {0.0, {}});
  for (int trial = 0; trial < 3; ++trial) {
    const arm::Configuration at = arm::forward(arm, test::random_posture(arm, random));
    require(is_finite(at.X_AE), "the end is not finite");
    require(arm::jacobian(arm, at).allFinite(), "the Jacobian is not finite");
    require(std::isfinite(collision.clearance(at, 1)), "the clearance is not finite");
  }
}

}  // namespace prehend::fuzz
