#pragma once

#include <filesystem>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/mapping_model.hpp"

namespace prehend::mapping {

/// A mapping model in a sealed file (kind «mapping-model»). Refused: a file that is damaged, is not
/// a mapping model, or was trained for another hand or for another version of this one (other DoF
/// or limits).
Expected<MappingModel> load_mapping_model(const std::filesystem::path& file,
                                          const model::HandModel& hand);
Expected<void> save_mapping_model(const std::filesystem::path& file, const MappingModel& model,
                                  const model::HandModel& hand);

}  // namespace prehend::mapping
