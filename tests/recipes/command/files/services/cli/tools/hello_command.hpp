#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend hello`: says hello. Returns the exit code.
int hello_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
