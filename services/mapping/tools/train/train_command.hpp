#pragma once

#include <string>
#include <vector>

namespace prehend::mapping {

/// `prehend train`; returns the exit code.
int train_command(const std::vector<std::string>& arguments);

}  // namespace prehend::mapping
