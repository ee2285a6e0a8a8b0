#pragma once

#include <string>
#include <vector>

namespace prehend::demonstration {

/// `prehend-person`; returns the exit code.
int person_command(const std::vector<std::string>& arguments);

}  // namespace prehend::demonstration
