#pragma once

#include <filesystem>
#include <string>

#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {

/// Models as bytes (protobuf, see common/proto/object_model.proto) and back; what comes back has
/// been checked for sizes and finiteness.
std::string to_bytes(const ObjectModels& models);
Expected<ObjectModels> from_bytes(const std::string& bytes);

/// The same in a sealed file, which is refused when a bit of it changed.
Expected<void> save_models(const std::filesystem::path& file, const ObjectModels& models);
Expected<ObjectModels> load_models(const std::filesystem::path& file);

}  // namespace prehend::recognition
