#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"

// Whoever only starts a program needs nothing of CLI11, whose headers take seconds to compile.
namespace CLI {
class App;
}

/// What every command of `prehend` shares: arguments, messages, exit codes.
namespace prehend::tool {

/// Says what is wrong, on one line, and returns the exit code. An error without words has been
/// told.
int complain(const Error& error);
int complain(const Error& error, int exit_code);

/// Log lines look from now on as --log among the arguments, or else PREHEND_LOG, says; those of
/// programs that this one starts, too. parse() does this first; a program that says something
/// before it parses calls it itself.
void choose_log(const std::vector<std::string>& arguments);

/// Parses, with --log beside the options of the app and its subcommands; what takes numbers takes
/// finite ones. On --help or wrong use it says what there is to say and returns the exit code.
std::optional<int> parse(CLI::App& app, const std::vector<std::string>& arguments);
std::optional<int> parse(CLI::App& app, int argc, char** argv);

/// A program of several subcommands, one of which is run: `prehend NAME COMMAND ...`.
class Program {
 public:
  Program(const std::string& name, const std::string& description);
  ~Program();

  /// Where subcommands are added.
  CLI::App& app() { return *app_; }
  /// What a subcommand does once it is parsed; it returns the exit code.
  void on(CLI::App& command, std::function<int()> run);
  /// Parses and runs; returns the exit code of the process.
  int run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
  int exit_code_ = exit_done;
};

}  // namespace prehend::tool
