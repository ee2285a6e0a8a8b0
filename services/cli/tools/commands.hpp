#pragma once

#include <string>
#include <vector>

namespace prehend::cli {

/// All commands of `prehend`, a line each.
std::string help();

/// Runs the command that the first argument names, of which there must be one, with the others.
/// Returns the exit code.
int run(const std::vector<std::string>& arguments);

}  // namespace prehend::cli
