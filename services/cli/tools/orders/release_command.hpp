#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend release`: ends a stop, for a reason.
int release_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
