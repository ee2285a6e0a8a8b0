#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::planner {

/// Is it a xacro file that must be expanded to be a URDF?
bool is_xacro(const std::string& text);

/// The URDF that the program `xacro` on the PATH makes of a file; arguments: NAME:=VALUE each.
/// Fails where there is no such program or it fails, with what it said last.
Expected<std::string> expand_xacro(const std::filesystem::path& file,
                                   const std::vector<std::string>& arguments);

}  // namespace prehend::planner
