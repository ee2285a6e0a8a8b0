#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend demo --hands`. Returns the exit code.
int carry_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
