#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend status`. Returns the exit code.
int status_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
