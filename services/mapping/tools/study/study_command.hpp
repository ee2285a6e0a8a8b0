#pragma once

#include <string>
#include <vector>

namespace prehend::mapping {

/// `prehend study`; returns the exit code.
int study_command(const std::vector<std::string>& arguments);

}  // namespace prehend::mapping
