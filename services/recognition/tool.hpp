#pragma once

#include <CLI/CLI.hpp>

namespace prehend::recognition {

/// Each adds its subcommand of `prehend objects`; exit_code is set when it has run: 0 done, 1 the
/// answer is no, 2 wrong use, 3 something that is needed is missing or broken.
void add_render(CLI::App& app, int& exit_code);
void add_train(CLI::App& app, int& exit_code);
void add_add(CLI::App& app, int& exit_code);
void add_detect(CLI::App& app, int& exit_code);
void add_evaluate(CLI::App& app, int& exit_code);
void add_scenes(CLI::App& app, int& exit_code);

}  // namespace prehend::recognition
