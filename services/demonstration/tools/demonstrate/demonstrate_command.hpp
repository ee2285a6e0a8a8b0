#pragma once

#include <string>
#include <vector>

namespace prehend::demonstration {

/// `prehend demonstrate`; returns the exit code.
int demonstrate_command(const std::vector<std::string>& arguments);

}  // namespace prehend::demonstration
