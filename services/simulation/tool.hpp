#pragma once

#include <CLI/CLI.hpp>

namespace prehend::simulation {

/// Each adds its subcommand of `prehend grasp`; exit_code is set when it has run: 0 done, 1 the
/// answer is no, 2 wrong use or file, 3 something that is needed is missing or broken.
void add_quality(CLI::App& app, int& exit_code);

}  // namespace prehend::simulation
