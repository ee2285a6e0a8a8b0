#pragma once

#include <string>

#include "common/base/error.hpp"
#include "common/model/arm_model.hpp"

namespace prehend::model {

/// The arm of this name, or in this folder. An unknown one is wrong use.
Expected<ArmModel> load_arm(const std::string& name);

}  // namespace prehend::model
