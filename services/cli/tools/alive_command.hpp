#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend alive`: does the service on this host answer for itself? Returns the exit code.
int alive_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
