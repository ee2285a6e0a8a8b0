#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend scene`: draws a scene and writes it. Returns the exit code.
int scene_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
