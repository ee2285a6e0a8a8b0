#pragma once

#include <string>
#include <vector>

namespace prehend::mapping {

/// `prehend teach`; returns the exit code.
int teach_command(const std::vector<std::string>& arguments);

}  // namespace prehend::mapping
