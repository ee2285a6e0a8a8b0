#pragma once

#include <string>
#include <vector>

namespace prehend::recorder {

/// `prehend check`; returns the exit code.
int check_command(const std::vector<std::string>& arguments);

}  // namespace prehend::recorder
