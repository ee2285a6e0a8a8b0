#pragma once

#include <functional>
#include <string>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// The text of a file that <include> names, as it is written there.
using IncludeReader = std::function<Expected<std::string>(const std::string& file)>;

/// Is it MJCF, MuJoCo's own format?
bool is_mjcf(const std::string& text);

/// Reads any bytes; fails only on what is no XML with a <mujoco> in it. Bodies become links, the
/// joints of one body a chain of links without mass; where equalities or tendons couple joints, one
/// leads and the others have <mimic>. Values of joints are MuJoCo's. Geoms that touch nothing are
/// visuals. What is beside the hand in the same world is left out, and told.
Expected<Robot> read_mjcf(const std::string& text, const IncludeReader& includes = {});

}  // namespace prehend::planner
