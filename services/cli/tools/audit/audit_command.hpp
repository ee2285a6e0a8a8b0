#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend audit`: who led, stopped and released robot hands.
int audit_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
