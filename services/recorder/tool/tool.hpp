#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <prehend/base/error.hpp>
#include <prehend/mcap/reader.hpp>
#include <string>
#include <vector>

namespace prehend::recorder {

enum ExitCode { exit_done = 0, exit_no = 1, exit_wrong_use = 2, exit_broken = 3 };

/// Each adds its subcommand, whose callback sets the exit code.
void add_info(CLI::App& app, int& exit_code);
void add_cut(CLI::App& app, int& exit_code);
void add_merge(CLI::App& app, int& exit_code);
void add_recover(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_diff(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_records(CLI::App& app, int& exit_code);
void add_write(CLI::App& app, int& exit_code);

/// Says what is wrong on one line and returns the exit code.
int complain(const Error& error, int exit_code);
/// The same for a file: broken where it cannot be read, else «no».
int complain_of(const std::filesystem::path& file, const Error& error);

/// Which topics are meant: a shell pattern (* and ?) matches whole names; none at all: every topic.
bool matches(const std::vector<std::string>& patterns, const std::string& topic);

}  // namespace prehend::recorder
