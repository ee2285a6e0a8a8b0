#pragma once

#include <string>
#include <vector>

namespace prehend::mapping {

/// `prehend benchmark`; returns the exit code.
int benchmark_command(const std::vector<std::string>& arguments);

}  // namespace prehend::mapping
