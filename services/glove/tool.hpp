#pragma once

#include <CLI/CLI.hpp>

namespace prehend::glove {

/// Each adds its subcommand, whose callback sets the exit code.
void add_decode(CLI::App& app, int& exit_code);
void add_emulate(CLI::App& app, int& exit_code);
void add_calibrate(CLI::App& app, int& exit_code);
void add_register(CLI::App& app, int& exit_code);
void add_watch(CLI::App& app, int& exit_code);
void add_filter_report(CLI::App& app, int& exit_code);

}  // namespace prehend::glove
