#pragma once

#include <vector>

#include "mesh.hpp"
#include "robot.hpp"

namespace prehend::hands {

/// All that is missing or suspicious in a robot that shall be a hand, errors first. Without an
/// error `prehend hand add` can make a hand of it.
std::vector<Finding> check(const Robot& robot, const MeshReader& meshes);

bool is_usable(const std::vector<Finding>& findings);

}  // namespace prehend::hands
