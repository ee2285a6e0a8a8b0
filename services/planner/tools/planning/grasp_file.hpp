#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/grasping/planner.hpp"

namespace prehend::planner {

/// Protobuf bytes of a plan, the same for the same plan, and the way back, which refuses what is
/// not finite, out of range or of the wrong length.
std::string serialise(const grasping::Plan& plan);
Expected<grasping::Plan> parse_plan(const std::string& bytes);

/// The same as a sealed file of kind «planned-grasps».
Expected<void> save(const std::filesystem::path& file, const grasping::Plan& plan);
Expected<grasping::Plan> load_plan(const std::filesystem::path& file);

}  // namespace prehend::planner
