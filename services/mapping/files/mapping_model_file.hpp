#pragma once

#include <filesystem>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/mapping_model.hpp"

namespace prehend::mapping {

/// A mapping model in a sealed file (kind «mapping-model»). Refused: a file that is damaged, is not
/// a mapping model, or was trained for another hand or for another version of this one (other DoF
/// or limits; where the file says for which, another digest than ModelPlaces::made_for).
Expected<MappingModel> load_mapping_model(const std::filesystem::path& file,
                                          const model::HandModel& hand,
                                          const std::string& made_for = {});
/// Whether the file is a mapping model that was made for the hand of this digest, or does not say.
bool was_made_for(const std::filesystem::path& file, const std::string& made_for);
Expected<void> save_mapping_model(const std::filesystem::path& file, const MappingModel& model,
                                  const model::HandModel& hand);

}  // namespace prehend::mapping
