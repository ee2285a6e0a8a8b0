#pragma once

#include <CLI/CLI.hpp>

namespace prehend::simulation {

/// Subcommands of `prehend grasp` about planned grasps; see tool.hpp.
void add_plan(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_picture(CLI::App& app, int& exit_code);
void add_table(CLI::App& app, int& exit_code);

}  // namespace prehend::simulation
