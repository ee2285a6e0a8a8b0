#pragma once

#include <string>
#include <vector>

namespace prehend::console {

/// Serves a file instead of a lab, until SIGTERM or Ctrl-C; returns the exit code.
int show_recording(const std::vector<std::string>& arguments);

}  // namespace prehend::console
