#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// Vertices of a solid's mesh in its own frame S, m (scaled). Fails where there is none to read.
using MeshReader = std::function<Expected<std::vector<Eigen::Vector3d>>(const Solid&)>;

/// Reads STL, OBJ, DAE and whatever else assimp knows. File names are relative to the folder of the
/// URDF, absolute, file:// or package://NAME/…; a package is looked for in the folders above the
/// URDF and in $ROS_PACKAGE_PATH.
MeshReader mesh_files(const std::filesystem::path& urdf);

/// The box, cylinder or sphere of least volume that holds all points, along their principal axes or
/// those of S, in frame S. Flat ones are given a thickness of 1 mm. points: at least one, finite.
Solid fit_primitive(const std::vector<Eigen::Vector3d>& points);

}  // namespace prehend::planner
