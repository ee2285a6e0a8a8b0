#pragma once

#include <functional>
#include <string>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/mapping_model.hpp"

namespace prehend::mapping {

/// The model of a hand, a name or a folder. Where there is none yet, or a user's hand has changed
/// since, prehend-train makes it first, which takes seconds; fails without words as soon as
/// `stopped` is true.
Expected<MappingModel> trained_model(const std::string& hand, const model::HandModel& model,
                                     const std::function<bool()>& stopped);

}  // namespace prehend::mapping
