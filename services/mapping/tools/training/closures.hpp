#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

struct ClosureOptions {
  Trials trials;
  std::string made_for;  // see ModelPlaces
  bool warns = true;     // of each grasp that is left out, and why
};

/// Closes the hand on every object of a catalogue file, which takes a minute, and saves the grasps.
/// Shows its progress.
Expected<std::vector<RobotGrasp>> close_and_save(const model::HandModel& hand, const Scheme& scheme,
                                                 const std::filesystem::path& catalogue_file,
                                                 const std::filesystem::path& grasps_file,
                                                 const ClosureOptions& options = {});

}  // namespace prehend::mapping
