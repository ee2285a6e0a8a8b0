#pragma once

#include <filesystem>
#include <string>

namespace prehend::mapping {

/// Where what was made for a hand lies, and how it imitates people. Those that come with us keep
/// it in trained/ and schemes/, users' hands in their own folders.
struct ModelPlaces {
  std::filesystem::path grasps;  // that the robot hand makes
  std::filesystem::path model;   // that was trained
  std::filesystem::path scheme;  // need not be there: then it is derived
};

/// hand: a name, or the path of a folder, as for model::hand_directory().
ModelPlaces model_places(const std::string& hand);

}  // namespace prehend::mapping
