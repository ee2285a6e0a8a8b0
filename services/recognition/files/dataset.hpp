#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// Pictures of single objects are compared at this size at most (longer side, px), so that pairs at
/// given distances mean the same in training and later.
inline constexpr int view_side = 256;

/// A picture file of one object, with the mask beside it (NAME.mask.png) or the middle of the
/// picture where there is none, made as small as models want it.
Expected<TrainingView> load_view(const std::filesystem::path& file);

/// The folders in a folder, sorted by name: each is a class, named as the folder. Not all are
/// without pictures.
struct ClassFolder {
  std::string name;
  std::vector<std::filesystem::path> files;
};
Expected<std::vector<ClassFolder>> class_folders(const std::filesystem::path& folder);

/// All views of a folder of class folders. `files` has the file of each view, class by class;
/// `left_out` says of each picture that could not be read why, and of folders without any.
struct Dataset {
  std::vector<TrainingClass> classes;
  std::vector<std::vector<std::filesystem::path>> files;
  std::vector<Error> left_out;
  bool masks = false;  // any picture has a mask beside it
};
Expected<Dataset> load_dataset(const std::filesystem::path& folder);

/// Objects cut out by masks are learned for the table, others as photos_of_objects().
DescriptorOptions suited_options(const Dataset& dataset);

}  // namespace prehend::recognition
