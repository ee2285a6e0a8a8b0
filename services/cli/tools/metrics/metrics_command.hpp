#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend metrics`. Returns the exit code.
int metrics_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
