#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "services/planner/tools/hand_import/mesh_place.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// Vertices of a solid's mesh in its own frame S, m (scaled). Fails where there is none to read.
/// One thread at a time.
using MeshReader = std::function<Expected<std::vector<Eigen::Vector3d>>(const Solid&)>;

/// Reads STL, OBJ, DAE and whatever else assimp knows, from where find_mesh() finds it. Vertices
/// are as they are in the file, in its <unit>; the up axis of Collada turns nothing, as in ROS.
MeshReader mesh_files(const std::filesystem::path& robot_file, const Packages& packages = {});

/// The box, cylinder or sphere of least volume that holds all points, along their principal axes or
/// those of S, in frame S. Flat ones are given a thickness of 1 mm. points: at least one, finite.
Solid fit_primitive(const std::vector<Eigen::Vector3d>& points);

}  // namespace prehend::planner
