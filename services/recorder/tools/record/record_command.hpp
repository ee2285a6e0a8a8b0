#pragma once

#include <string>
#include <vector>

namespace prehend::recorder {

/// `prehend record`; returns the exit code.
int record_command(const std::vector<std::string>& arguments);

}  // namespace prehend::recorder
