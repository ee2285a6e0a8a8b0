#include "common/tool/program.hpp"

#include <iostream>
#include <utility>

#include "common/base/log.hpp"

namespace prehend::tool {

int complain(const Error& error) {
  return complain(error, error.exit);
}

int complain(const Error& error, int exit_code) {
  if (const std::string message = error.message(); !message.empty()) log::error("{}", message);
  return exit_code;
}

std::optional<int> parse(CLI::App& app, const std::vector<std::string>& arguments) {
  // CLI11 wants them last first.
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return complain({error.what(), app.get_name(), "see --help"}, exit_wrong_use);
  }
  return std::nullopt;
}

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_wrong_use;
  }
  return std::nullopt;
}

Program::Program(const std::string& name, const std::string& description)
    : app_(description, "prehend " + name) {
  app_.require_subcommand(1);
  log::set_name(name);
}

void Program::on(CLI::App& command, std::function<int()> run) {
  command.callback([this, run = std::move(run)] { exit_code_ = run(); });
}

int Program::run(int argc, char** argv) {
  if (const auto ended = parse(app_, argc, argv)) return *ended;
  return exit_code_;
}

}  // namespace prehend::tool
