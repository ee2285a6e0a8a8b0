#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "finding.hpp"
#include "robot.hpp"

namespace prehend::hands {

/// Each adds its subcommand of `prehend hand`; exit_code is set when it has run.
void add_check(CLI::App& app, int& exit_code);
void add_add(CLI::App& app, int& exit_code);

/// The file's bytes as a robot. Errors name the file.
Expected<Robot> read_robot_file(const std::filesystem::path& file);

nlohmann::ordered_json to_json(const Finding& finding);
void print(const Finding& finding);  // on standard output, two lines

}  // namespace prehend::hands
