#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/planner/tools/hand_import/mesh_place.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace CLI {
class App;
}

namespace prehend::planner {

/// What a user says beside the name of a robot's file.
struct RobotFileOptions {
  Packages packages;               // before all other places
  std::vector<std::string> xacro;  // NAME:=VALUE each, if the file is xacro
};

/// Adds --package and --xacro to a command; `options` must outlive it.
void add_file_options(CLI::App& command, RobotFileOptions& options);

/// The file's bytes as a robot. Errors name the file.
Expected<Robot> read_robot_file(const std::filesystem::path& file,
                                const RobotFileOptions& options = {});

}  // namespace prehend::planner
