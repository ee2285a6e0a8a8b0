#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// `prehend takeover`: says whose commands a robot hand obeys.
int takeover_command(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
