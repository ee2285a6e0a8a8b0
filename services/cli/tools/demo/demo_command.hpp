#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend demo`. Returns the exit code.
int demo_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
