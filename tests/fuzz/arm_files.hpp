#pragma once

#include "common/model/arm_model.hpp"

namespace prehend::fuzz {

/// What every arm that was accepted must be: finite, whatever its joints do, with limits that allow
/// something.
void require_sound(const model::ArmModel& arm);

}  // namespace prehend::fuzz
