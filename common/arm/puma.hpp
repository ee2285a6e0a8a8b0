#pragma once

#include <optional>
#include <vector>

#include "common/arm/kinematics.hpp"

namespace prehend::arm {

/// An arm built as the Puma 560: two parallel axes behind a vertical one, set off to the side, and
/// three that meet in the wrist. Its inverse kinematics has a closed form with eight branches.
struct PumaForm {
  double a2 = 0, a3 = 0, d3 = 0, d4 = 0;  // m, of its Denavit-Hartenberg parameters
};

/// None for an arm of another build.
std::optional<PumaForm> puma_form(const model::ArmModel& arm);

/// All branches that put E there, in (-π, π], whatever the limits: none or two, mostly eight. At
/// the wrist's singularity, where only q4 + q6 counts, q4 is that of `near`.
std::vector<Joints> solve_puma(const model::ArmModel& arm, const PumaForm& form, const Pose& X_AE,
                               const Joints& near);

}  // namespace prehend::arm
