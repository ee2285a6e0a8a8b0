#pragma once

#include <optional>
#include <prehend/base/error.hpp>
#include <string>
#include <vector>

#include "config.hpp"

namespace CLI {
class App;
}

namespace prehend::service {

/// Exit codes of every subcommand.
enum ExitCode { exit_done = 0, exit_no = 1, exit_wrong_use = 2, exit_broken = 3 };

/// Which lab is meant: options that many programs share.
struct LabArguments {
  std::string config;             // lab.toml; empty: the one that came with the programs
  std::vector<std::string> sets;  // table.key=value
  std::optional<int> domain;      // instead of lab.domain

  void add_to(CLI::App& app);
  std::string file() const;
  /// The overrides with the domain among them.
  std::vector<std::string> overrides() const;
  Expected<Config> load() const;
  /// The same lab as the arguments of a service.
  std::vector<std::string> for_service() const;
};

/// Parses; on --help or wrong use it says what there is to say and returns the exit code.
std::optional<int> parse(CLI::App& app, const std::vector<std::string>& arguments);

/// Says what is wrong, on one line, and returns the exit code.
int complain(const Error& error, int exit_code);

}  // namespace prehend::service
