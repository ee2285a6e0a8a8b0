#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/model/scene.hpp"

namespace prehend::cli {

/// What a demonstration's scene is drawn from.
struct SettingOptions {
  std::uint64_t seed = 1;      // the same gives the same scene
  std::string object;          // what is reached for; empty: drawn among what the hand can hold
  std::filesystem::path hand;  // folder of the robot hand
  std::filesystem::path catalogue;  // file of the known objects
};

/// Draws the scene; its person reaches where the robot hand has room. A recording of a bare hand,
/// which knows no room, is put where its palm is aligned with a grasp of the object.
Expected<model::Scene> make_setting(const SettingOptions& options);

/// Writes the scene; the folder must exist.
Expected<void> write_setting(const model::Scene& scene, const std::filesystem::path& file);

}  // namespace prehend::cli
