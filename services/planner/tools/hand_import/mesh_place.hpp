#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/base/error.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// Folders of packages by their names, before all others.
using Packages = std::map<std::string, std::filesystem::path>;

/// The file that a solid of a robot's file means by its mesh. Names are relative to the folder of
/// the robot's file or to the solid's mesh_folder, absolute, file://, package://NAME/…,
/// model://NAME/… or $(find NAME)/…. A package is looked for in `packages`, $AMENT_PREFIX_PATH,
/// $ROS_PACKAGE_PATH and the folders above the robot's file; a file that is at none of these places
/// below the folder of the robot's file, where it must be the only one of its name. Fails with
/// where it was looked for.
Expected<std::filesystem::path> find_mesh(const Solid& solid,
                                          const std::filesystem::path& robot_file,
                                          const Packages& packages);

}  // namespace prehend::planner
