#pragma once

#include <string>
#include <vector>

namespace prehend::recorder {

/// `prehend replay`; returns the exit code.
int replay_command(const std::vector<std::string>& arguments);

}  // namespace prehend::recorder
