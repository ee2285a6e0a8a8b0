#pragma once

#include <filesystem>
#include <string>

namespace prehend::mapping {

/// Where what was made for a hand lies, and how it imitates people. Those that come with us keep
/// it in trained/ and schemes/, users' hands in their own folders, or, where these cannot be
/// written to, in a folder of the user's state.
struct ModelPlaces {
  std::filesystem::path grasps;  // that the robot hand makes
  std::filesystem::path model;   // that was trained
  std::filesystem::path scheme;  // need not be there: then it is derived
  /// Of users' hands: a digest of all that a hand's folder says of it. What was made for another
  /// one is made anew. Empty: the hand comes with us, and so does what was made for it.
  std::string made_for;
};

/// hand: a name, or the path of a folder, as for model::hand_directory().
ModelPlaces model_places(const std::string& hand);

}  // namespace prehend::mapping
