#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "services/planner/tools/hand_import/finding.hpp"
#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// The file's bytes as a robot. Errors name the file.
Expected<Robot> read_robot_file(const std::filesystem::path& file);

nlohmann::ordered_json to_json(const UrdfFinding& finding);
void print(const UrdfFinding& finding);  // on standard output, two lines

}  // namespace prehend::planner
