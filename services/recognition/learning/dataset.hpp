#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "object_models.hpp"

namespace prehend::recognition {

/// Pictures of single objects are compared at this size at most (longer side, px), so that pairs at
/// given distances mean the same in training and later.
inline constexpr int view_side = 256;

/// A picture file of one object, with the mask beside it (NAME.mask.png) or the middle of the
/// picture where there is none, made as small as models want it.
Expected<TrainingView> load_view(const std::filesystem::path& file);

/// The folders in a folder, sorted by name: each is a class, named as the folder.
struct ClassFolder {
  std::string name;
  std::vector<std::filesystem::path> files;
};
Expected<std::vector<ClassFolder>> class_folders(const std::filesystem::path& folder);

}  // namespace prehend::recognition
